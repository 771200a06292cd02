"""What a plan by load saves over the best single way for all loads: `python -m benchmarks.by_load`.

Both in the same run, by processor time; "one way" is the cheapest plan of a single part below full contact.
"""

from __future__ import annotations

import math
from time import process_time

import numpy as np

from weier import Profile, random_phases
from weier.methods.errors import OutOfReachError
from weier.methods.planned import curve as planned
from weier.methods.planned.candidates import ways
from weier.methods.planned.plan import cheapest, plan
from weier.methods.planned.segment import Part

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
    print("| profile | quantity | tolerance | by load | seconds | one way | seconds | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for profile, quantity, tolerance in CASES:
        by_load, alone = plan(profile, LOADS, tolerance, quantity).parts, one_way(profile, quantity, tolerance)
        took, single = seconds(profile, by_load), seconds(profile, alone)
        what = f"{profile.describe()} | {quantity} | {tolerance:g}"
        print(f"| {what} | {names(by_load)} | {took:.3g} | {names(alone)} | {single:.3g} | {single / took:.2g} |")


def one_way(profile: Profile, quantity: str, tolerance: float) -> tuple[Part, ...]:
    """The cheapest of the ways that do for all loads alone, but for full contact.

    Raises
    ------
    OutOfReachError
        If none does.
    """
    flat, others = [], []
    for way in ways(profile, LOADS, tolerance, quantity):
        (flat if way.method == "full contact" and way.terms == profile.m else others).append(way)
    plans = []
    for way in others:
        pair = [way, *flat]
        if np.all(np.any([each.error <= tolerance for each in pair], axis=0)):
            plans.append(cheapest(pair, tolerance))
    if not plans:
        raise OutOfReachError(f"no single way reaches {tolerance:g} for {profile.describe()}")
    return min(plans, key=lambda parts: sum(part.seconds for part in parts))


def seconds(profile: Profile, parts: tuple[Part, ...]) -> float:
    """The least of two runs."""
    least = math.inf
    for _ in range(2):
        start = process_time()
        planned.run(profile, parts)
        least = min(least, process_time() - start)
    return least


def names(parts: tuple[Part, ...]) -> str:
    """Loads and methods of parts."""
    return ", ".join(f"{part.mean_pressure.size} {part.method}" for part in parts)


if __name__ == "__main__":
    main()
