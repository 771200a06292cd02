"""Is a planned curve as accurate as it says, and no more? On random profiles, against more than the plan took."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier import bem, laws, patches, planned
from weier.bounds import complete_bounds
from weier.phases import random_phases
from weier.plan import QUANTITIES
from weier.profile import Profile
from weier.terms import truncated

Array = NDArray[np.float64]

GAMMAS = ("3/2", "2", "5/2", "3", "4", "5")
MOST_TERMS = 5
MOST_WAVES = 81  # in a period: patches then take seconds a profile
MOST_ENDLESS_POINTS = 2**16  # that stand for an endless series
LOADS = np.geomspace(1e-3, 10, 12)
TRUTH = 1e-12
MOST_TOLERANCE = 0.1


class Check(NamedTuple):
    """Largest errors over the loads, in g_0; of a resistance relative to the larger of itself and 1 g_0/p_0*.

    `inside` is whether each load is within what its own number expects.
    """

    expected: float
    true: float
    inside: bool


class Verified(NamedTuple):
    """One planned curve: what it was to be, its errors, and the methods it took, from the lightest load up.

    The resistance of an endless series is None: nothing tells the truth.
    """

    profile: Profile
    quantity: str
    tolerance: float
    compliance: Check
    resistance: Check | None
    methods: tuple[str, ...]

    @property
    def inside(self) -> bool:
        """Whether each load of both quantities is within what its own number expects."""
        return self.compliance.inside and (self.resistance is None or self.resistance.inside)

    @property
    def kept(self) -> bool:
        """Whether the quantity planned for is within its tolerance."""
        check = self.compliance if self.quantity == "compliance" else self.resistance
        return check is not None and check.true <= self.tolerance


def verify(count: int, seed: int = 0) -> Iterator[Verified]:
    """Random profiles, quantities and tolerances: D in (1.05, 1.95), up to 5 terms, tolerance from 1e-6 to 0.3."""
    random = np.random.default_rng(seed)
    done = 0
    while done < count:
        D, gamma, m = random.uniform(1.05, 1.95), str(random.choice(GAMMAS)), int(random.integers(1, MOST_TERMS + 1))
        profile = Profile(D, gamma, m, random_phases(int(random.integers(2**31))))
        tolerance, quantity = 10 ** random.uniform(-6, np.log10(0.3)), str(random.choice(QUANTITIES))
        if profile.wavenumber[-1] <= MOST_WAVES:
            done += 1
            yield _against_patches(profile, quantity, tolerance)


def verify_endless(count: int, seed: int = 0) -> Iterator[Verified]:
    """Random endless series, D in (1.05, 1.7), to 0.1 g_0 or less, as 2^16 points tell the truth."""
    random = np.random.default_rng(seed)
    done = 0
    while done < count:
        D, gamma = random.uniform(1.05, 1.7), str(random.choice(GAMMAS))
        profile = Profile(D, gamma, math.inf, random_phases(int(random.integers(2**31))))
        known = truncated(profile, _longest(profile).terms - 1).tail_amplitude
        tolerance = known * (MOST_TOLERANCE / known) ** random.random()
        if known < MOST_TOLERANCE:
            done += 1
            yield _against_more_terms(profile, tolerance)


def _against_patches(profile: Profile, quantity: str, tolerance: float) -> Verified:
    exact, found = patches.curve(profile, LOADS, TRUTH), planned.curve(profile, LOADS, tolerance, quantity)
    slack = laws.RESIDUAL * exact.residual + laws.FLOOR * profile.total_amplitude
    h = _check(found.compliance - exact.compliance, found.compliance_error, slack)
    scale = np.maximum(exact.resistance, 1)
    blur = np.full(LOADS.size, laws.patches_error(TRUTH, "resistance"))
    R = _check((found.resistance - exact.resistance) / scale, found.resistance_error / scale, blur)
    return Verified(profile, quantity, tolerance, h, R, _methods(found))


def _against_more_terms(profile: Profile, tolerance: float) -> Verified:
    """The truth lies within [h_k, h_k + 2 G_k], and below full contact."""
    kept, found = _longest(profile), planned.curve(profile, LOADS, tolerance)
    points = laws.FEWEST_PER_WAVE * kept.wavenumber[-1]
    h = bem.curve(kept, LOADS, points=points, tolerance=1e-8, resistance=False).compliance
    low, high = complete_bounds(h, kept.tail_amplitude, profile.total_amplitude)
    slack = (high - low) / 2 + laws.bem_compliance_error(kept, points)
    check = _check(found.compliance - (low + high) / 2, found.compliance_error, slack)
    return Verified(profile, "compliance", tolerance, check, None, _methods(found))


def _check(off: Array, expected: Array, slack: Array) -> Check:
    true = np.abs(off)
    return Check(float(expected.max()), float(true.max()), bool(np.all(true <= expected + slack)))


def _longest(profile: Profile) -> Profile:
    """As many terms of an endless series as 2^16 points show."""
    terms = 1
    while truncated(profile, terms + 1).wavenumber[-1] * laws.FEWEST_PER_WAVE <= MOST_ENDLESS_POINTS:
        terms += 1
    return truncated(profile, terms)


def _methods(found: planned.Curve) -> tuple[str, ...]:
    return tuple(dict.fromkeys(found.planned_method.tolist()))
