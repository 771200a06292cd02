"""Phases of the terms of a series: one for all, one for each, or random."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from weier.kernels.arrays import Array
from weier.theory.arguments import checked_numbers, shown


@dataclass(frozen=True)
class RandomPhases:
    """Independent phases, uniform in [0, 2 pi): `first(m)` are the first m of one sequence without end."""

    seed: int

    def first(self, m: int) -> Array:
        """The first m phases, shape (m,), in radians."""
        return np.random.default_rng(self.seed).uniform(0, 2 * np.pi, m)


def random_phases(seed: int) -> RandomPhases:
    """Phases drawn from `seed`; a longer series extends a shorter one of the same seed.

    Raises
    ------
    ValueError
        If `seed` is not a non-negative integer.

    Examples
    --------
    >>> import weier
    >>> weier.Profile(D=1.25, gamma=5, m=2, phases=weier.random_phases(7)).phase.round(3)
    array([3.928, 5.637])
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed must be a non-negative integer, got {shown(seed)}")
    return RandomPhases(int(seed))


Phases = float | tuple[float, ...] | RandomPhases


def checked_phases(phases: float | Sequence[float] | Array | RandomPhases, m: float) -> Phases:
    """The phases, if they are finite, and one for all terms or one for each of m."""
    if isinstance(phases, RandomPhases):
        return phases
    values = checked_numbers("phases", phases, "be finite numbers in radians", np.isfinite)
    if values.ndim > 1:
        raise ValueError(f"phases must be finite numbers in radians, a number or one list, got {shown(phases)}")
    if values.ndim == 0:
        return float(values)
    if values.size != m:
        raise ValueError(
            f"phases must be one number for all terms or one for each of the m = {m:g} terms, got {values.size}"
        )
    return tuple(values.tolist())
