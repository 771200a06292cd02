"""What a plan by load saves over the best single method for all loads: `python -m benchmarks.by_load`.

Both are timed in the same run, by processor time. "One method" is the cheapest plan with a single segment below full
contact.
"""

from __future__ import annotations

import math
from time import process_time

import numpy as np

from weier import Profile, plan, random_phases
from weier.methods.errors import OutOfReachError
from weier.methods.planned import solver
from weier.methods.planned.candidates import FULL_CONTACT, candidates
from weier.methods.planned.plan import cheapest
from weier.methods.registry import METHODS
from weier.methods.segment import Segment

LOADS = np.geomspace(1e-3, 10, 40)
CASES = (
    (Profile(1.25, 5, 3, random_phases(1)), "compliance", 1e-3),
    (Profile(1.25, 5, 3, random_phases(1)), "compliance", 1e-6),
    (Profile(1.25, 5, 3, random_phases(1)), "resistance", 1e-2),
    (Profile(1.5, 3, 4, random_phases(2)), "compliance", 1e-6),
    (Profile(1.5, 3, 4, random_phases(2)), "resistance", 1e-2),
    (Profile(1.25, 5, 5, random_phases(1)), "compliance", 1e-2),
    (Profile(1.25, 5, 5, random_phases(1)), "compliance", 1e-6),
    (Profile(1.5, 2, 8, random_phases(3)), "compliance", 1e-5),
    (Profile(1.1, 5, 8, random_phases(2)), "compliance", 1e-2),
    (Profile(1.25, 5, math.inf, random_phases(1)), "compliance", 0.05),
)


def main() -> None:
    """Print both times of each case, and their ratio."""
    print("| profile | quantity | tolerance | by load | seconds | one method | seconds | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for profile, quantity, tolerance in CASES:
        by_load, alone = plan(profile, LOADS, tolerance, quantity).segments, one_method(profile, quantity, tolerance)
        took, single = seconds(profile, by_load), seconds(profile, alone)
        case = f"{profile.describe()} | {quantity} | {tolerance:g}"
        print(f"| {case} | {names(by_load)} | {took:.3g} | {names(alone)} | {single:.3g} | {single / took:.2g} |")


def one_method(profile: Profile, quantity: str, tolerance: float) -> tuple[Segment, ...]:
    """The cheapest candidate that reaches the tolerance at all loads by itself, but for full contact."""
    full_contact, others = [], []
    for candidate in candidates(profile, LOADS, tolerance, quantity, METHODS):
        is_full = candidate.method == FULL_CONTACT and candidate.terms == profile.m
        (full_contact if is_full else others).append(candidate)
    plans = []
    for candidate in others:
        pair = [candidate, *full_contact]
        if np.all(np.any([each.error <= tolerance for each in pair], axis=0)):
            plans.append(cheapest(pair, tolerance))
    if not plans:
        raise OutOfReachError(f"no single method reaches {tolerance:g} for {profile.describe()}")
    return min(plans, key=lambda segments: sum(segment.seconds for segment in segments))


def seconds(profile: Profile, segments: tuple[Segment, ...]) -> float:
    """Processor time of these segments, the least of two runs."""
    least = math.inf
    for _ in range(2):
        start = process_time()
        solver.run(profile, segments)
        least = min(least, process_time() - start)
    return least


def names(segments: tuple[Segment, ...]) -> str:
    """Loads and methods of segments."""
    return ", ".join(f"{segment.mean_pressure.size} {segment.method}" for segment in segments)


if __name__ == "__main__":
    main()
