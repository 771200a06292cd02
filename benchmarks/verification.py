"""Is a planned curve as accurate as it says, and no more? On random profiles, against more than the plan took."""

from __future__ import annotations

import math
from collections.abc import Iterator
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from weier import plan
from weier.kernels.arrays import Array
from weier.methods import bem, error_model, patches
from weier.methods.plan_part import QUANTITIES
from weier.methods.planned.solver import PlannedCurve
from weier.methods.registry import PLANNED, find_method
from weier.surface.profile import Profile, RandomPhases, random_phases
from weier.theory.bounds import complete_bounds

# The random series: their ratios, sizes, phases and loads.
GAMMAS = ("3/2", "2", "5/2", "3", "4", "5")
MAX_TERMS = 5
MAX_WAVES = 81  # Contact patches take seconds a profile with so many waves in a period.
MAX_POINTS = 2**16  # Points of the longest truncated series in place of the infinite one.
PHASES = ("zero", "pi", "half a node", "random")
MIN_LOAD, MAX_LOAD, COUNT = 1e-12, 10.0, 12  # p_0*: each series has 12 loads from one contact to full contact.
REFERENCE_TOLERANCE = 1e-11  # g_0: of contact patches, far below all tolerances of plans.
MAX_TOLERANCE = 0.1  # Tolerances are drawn up to this one.


class Check(NamedTuple):
    """Largest errors over the loads, in g_0; of a resistance relative to the larger of itself and 1 g_0/p_0*.

    `inside` is whether each load is within what its own number expects.
    """

    expected: float
    true: float
    inside: bool


class Verified(NamedTuple):
    """One planned curve: what it was to be, its errors, and the methods it took, from the lightest load up.

    `points` is the finest grid, NaN without any. `planned_seconds` and `seconds` are what the plan expected and what
    it took, in processor time.

    The resistance of an infinite series is None, because there is no reference for it.
    """

    profile: Profile
    quantity: str
    tolerance: float
    compliance: Check
    resistance: Check | None
    methods: tuple[str, ...]
    points: float
    planned_seconds: float
    seconds: float

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
    """Random profiles, quantities and tolerances: D in (1.05, 1.95), up to 5 terms, tolerance from 1e-6 to 0.3.

    Loads from 1e-12 to 10 p_0*, anywhere; phases random or such that crests coincide, stand in pairs, or all stand
    half a node off the grid.
    """
    random = np.random.default_rng(seed)
    done = 0
    while done < count:
        D, gamma, m = random.uniform(1.05, 1.95), str(random.choice(GAMMAS)), int(random.integers(1, MAX_TERMS + 1))
        tolerance, quantity = 10 ** random.uniform(-6, np.log10(0.3)), str(random.choice(QUANTITIES))
        kind, seed = str(random.choice(PHASES)), int(random.integers(2**31))
        loads = _loads(random)
        if Profile(D, gamma, m).waves_per_period[-1] <= MAX_WAVES:
            done += 1
            profile = Profile(D, gamma, m, _phases(kind, Profile(D, gamma, m), seed, (loads, tolerance, quantity)))
            yield _against_patches(profile, loads, quantity, tolerance)


def verify_infinite(count: int, seed: int = 0) -> Iterator[Verified]:
    """Random infinite series, D in (1.05, 1.7), to 0.1 g_0 or less, against 2^16 points."""
    random = np.random.default_rng(seed)
    done = 0
    while done < count:
        D, gamma = random.uniform(1.05, 1.7), str(random.choice(GAMMAS))
        profile = Profile(D, gamma, math.inf, random_phases(int(random.integers(2**31))))
        known = profile.truncated(_longest(profile).terms - 1).tail_amplitude
        tolerance = known * (MAX_TOLERANCE / known) ** random.random()
        loads = _loads(random)
        if known < MAX_TOLERANCE:
            done += 1
            yield _against_more_terms(profile, loads, tolerance)


def _loads(random: np.random.Generator) -> Array:
    return np.sort(np.exp(random.uniform(math.log(MIN_LOAD), math.log(MAX_LOAD), COUNT)))


def _phases(
    kind: str, series: Profile, seed: int, wanted: tuple[Array, float, str]
) -> float | tuple[float, ...] | RandomPhases:
    """Phases of a kind; half a node off the grid that the plan takes, if it takes any, whatever the phases."""
    if kind == "half a node":
        grids = [part.settings["points"] for part in plan(series, *wanted).parts if "points" in part.settings]
        if grids:
            return tuple(-math.pi * waves / grids[0] for waves in series.waves_per_period)
    return {"zero": 0.0, "pi": math.pi}.get(kind, random_phases(seed))


def _against_patches(profile: Profile, loads: Array, quantity: str, tolerance: float) -> Verified:
    exact = patches.curve(profile, loads, REFERENCE_TOLERANCE)
    found, seconds = _planned(profile, loads, tolerance, quantity)
    slack = error_model.RESIDUAL_FACTOR * exact.residual + error_model.COMPLIANCE_ROUNDING * profile.total_amplitude
    h = _check(found.compliance - exact.compliance, found.compliance_error, slack)
    scale = np.maximum(exact.resistance, 1)
    R = _check(
        (found.resistance - exact.resistance) / scale, found.resistance_error / scale, exact.resistance_error / scale
    )
    return Verified(profile, quantity, tolerance, h, R, *_methods(found), found.planned_seconds, seconds)


def _against_more_terms(profile: Profile, loads: Array, tolerance: float) -> Verified:
    """The infinite series lies within [h_k, h_k + 2 G_k], and below full contact."""
    kept, (found, seconds) = _longest(profile), _planned(profile, loads, tolerance)
    points = bem.error_model.MIN_MEASURED_POINTS * kept.waves_per_period[-1]
    h = bem.curve(kept, loads, points=points, max_residual=1e-8, with_resistance=False, staircase="kept").compliance
    low, high = complete_bounds(h, kept.tail_amplitude, profile.total_amplitude)
    slack = (high - low) / 2 + bem.error_model.compliance_error(kept, points)
    check = _check(found.compliance - (low + high) / 2, found.compliance_error, slack)
    return Verified(profile, "compliance", tolerance, check, None, *_methods(found), found.planned_seconds, seconds)


def _planned(profile: Profile, loads: Array, *wanted: Any) -> tuple[PlannedCurve, float]:
    """The planned curve, and the seconds of the processor that it took."""
    plan(profile, loads, *wanted)  # contacts are counted once
    start = process_time()
    curve = find_method(PLANNED).solve(profile, loads, *wanted)
    return curve, process_time() - start


def _check(off: Array, expected: Array, slack: Array) -> Check:
    true = np.abs(off)
    return Check(float(expected.max()), float(true.max()), bool(np.all(true <= expected + slack)))


def _longest(profile: Profile) -> Profile:
    """As many terms of an infinite series as 2^16 points show."""
    terms = 1
    while profile.truncated(terms + 1).waves_per_period[-1] * bem.error_model.MIN_MEASURED_POINTS <= MAX_POINTS:
        terms += 1
    return profile.truncated(terms)


def _methods(found: PlannedCurve) -> tuple[tuple[str, ...], float]:
    """The methods and the finest grid."""
    return tuple(dict.fromkeys(found.planned_method.tolist())), float(np.fmax.reduce(found.planned_points))
