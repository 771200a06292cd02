"""What closed-form estimates of a whole series have in common: how they are run."""

from __future__ import annotations

from collections.abc import Callable

from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.method import Estimate
from weier.surface.profile import Profile

Formula = Callable[[ArrayLike, ArrayLike, ArrayLike, ArrayLike], Array]  # The arguments are loads, D, gamma and m.


def solve_by(compliance: Formula, resistance: Formula) -> Callable[[Profile, Array], Estimate]:
    """Return the solver of a method that has closed forms for compliance and resistance."""

    def solve(profile: Profile, loads: Array) -> Estimate:
        series = profile.D, float(profile.gamma), profile.m
        return Estimate(compliance(loads, *series), resistance(loads, *series))

    return solve
