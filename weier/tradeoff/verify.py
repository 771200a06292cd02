"""Is a planned curve as accurate as it says, and no more? On random profiles, against the contact patches."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from weier import laws, patches, planned
from weier.plan import QUANTITIES, plan
from weier.profile import Profile, random_phases

GAMMAS = ("3/2", "2", "5/2", "3", "4", "5")
MOST_TERMS = 5
MOST_WAVES = 81  # in a period: patches then take seconds a profile
LOADS = np.geomspace(1e-3, 10, 12)
TRUTH = 1e-12


class Verified(NamedTuple):
    """One planned curve: what it was to be, the error it expects, the one it has, and the methods it took.

    Errors are the largest over the loads, in g_0; of a resistance relative to the larger of itself and 1 g_0/p_0*.
    `inside` is whether each load is within what its own number expects.
    """

    profile: Profile
    quantity: str
    tolerance: float
    expected: float
    true: float
    inside: bool
    methods: tuple[str, ...]


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
            yield _verified(profile, quantity, tolerance)


def _verified(profile: Profile, quantity: str, tolerance: float) -> Verified:
    exact = patches.curve(profile, LOADS, TRUTH)
    found = planned.curve(profile, LOADS, tolerance, quantity)
    scale = np.ones(LOADS.size) if quantity == "compliance" else np.maximum(exact.resistance, 1)
    true = np.abs(getattr(found, quantity) - getattr(exact, quantity)) / scale
    expected = getattr(found, f"{quantity}_error") / scale
    methods = tuple(part.method for part in plan(profile, LOADS, tolerance, quantity).parts)
    inside = bool(np.all(true <= expected + laws.patches_error(TRUTH, quantity)))
    return Verified(profile, quantity, tolerance, float(expected.max()), float(true.max()), inside, methods)
