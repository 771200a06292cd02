"""What closed-form estimates of a whole series have in common: how they are run, and their reference."""

from __future__ import annotations

from collections.abc import Callable

from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.method import Estimate, Reference
from weier.surface.profile import Profile

Formula = Callable[[ArrayLike, ArrayLike, ArrayLike, ArrayLike], Array]  # The arguments are loads, D, gamma and m.


def solve_by(compliance: Formula, resistance: Formula) -> Callable[[Profile, Array], Estimate]:
    """The solver of a method that has closed forms for compliance and resistance."""

    def solve(profile: Profile, loads: Array) -> Estimate:
        series = profile.D, float(profile.gamma), profile.m
        return Estimate(compliance(loads, *series), resistance(loads, *series))

    return solve


def multiprecision_sums(name: str) -> Callable[[Profile, Array], Reference]:
    """The reference of an estimate: its sums, by the function of this name in `weier.methods.multiprecision`."""

    def reference(profile: Profile, loads: Array) -> Reference:
        from weier.methods import multiprecision  # mpmath, which only the stability report needs

        return multiprecision.reference(getattr(multiprecision, name), profile, loads)

    return reference
