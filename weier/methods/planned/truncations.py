"""The truncated series that may stand for the whole one, and what the terms that they leave out may change."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem.error_model import MAX_POINTS, MIN_MEASURED_POINTS
from weier.methods.planned import forecast
from weier.methods.segment import COMPLIANCE, Task
from weier.theory.profile import Profile, terms_within

MAX_LENGTHS = 4  # numbers of terms to compare, from the fewest whose tail the tolerance allows
BOUND_SHARE = 0.1  # of the amplitude left out, that a method may be off where it finds bounds on the resistance
SHARES = np.geomspace(1e-6, 0.999, 120)  # of a load, by which another is lighter; the same of heavier ones
MAX_LOAD = 1e300  # p_0*: more is foreseen as this, since ten times as much is a number


def resolvable_lengths(profile: Profile) -> range:
    """Numbers of terms whose finest waves boundary elements can still resolve."""
    return range(1, terms_within(profile, MAX_POINTS / MIN_MEASURED_POINTS) + 1)


def truncation_tasks(
    profile: Profile, loads: Array, tolerance: float, lengths: Sequence[int], first_contact: float
) -> Iterator[Task]:
    """The compliance of the truncated series whose tail the tolerance allows."""
    enough = (terms for terms in lengths if profile.amplitude_beyond(terms) < tolerance)
    for terms in sorted({*islice(enough, MAX_LENGTHS), lengths[-1]}):
        kept, amplitude = profile.truncated(terms), profile.amplitude_beyond(terms)
        if 0 < amplitude < tolerance:
            contacts, error = forecast.contacts(kept, loads), np.full(loads.size, amplitude)
            yield Task(kept, loads, error, tolerance - amplitude, COMPLIANCE, contacts, first_contact)


def chord_tasks(profile: Profile, loads: Array, lengths: Sequence[int]) -> Iterator[tuple[Task, Array]]:
    """The resistance of a long series from the compliance of truncated ones, and the other loads that it takes.

    A concave curve lies below its tangents: the chords to two more loads, a lighter and a heavier one, hold the slope
    at each load. The bounds are narrower the more terms are resolved, and how many a load needs depends on the load.
    """
    for terms in lengths:
        kept, amplitude = profile.truncated(terms), profile.amplitude_beyond(terms)
        error = BOUND_SHARE * amplitude
        width, other_loads = expected_chords(kept, loads, amplitude + error)
        contacts = forecast.contacts(kept, loads)
        yield Task(kept, loads, width, error, COMPLIANCE, contacts, np.inf), other_loads


def expected_chords(kept: Profile, loads: Array, amplitude: float) -> tuple[Array, Array]:
    """How far apart the best chords will be, over the larger of the resistance and 1, and the loads they lead to.

    Expected from the layer model's curve, load by load: no load knows of another.
    """
    p = np.minimum(loads, MAX_LOAD)[:, None]
    here, lighter, heavier = forecast.compliance(kept, p), p * (1 - SHARES), p / (1 - SHARES)
    steepest = (here - forecast.compliance(kept, lighter) + 2 * amplitude) / (p - lighter)
    shallowest = (forecast.compliance(kept, heavier) - here - 2 * amplitude) / (heavier - p)
    best = steepest.argmin(axis=1, keepdims=True), shallowest.argmax(axis=1, keepdims=True)
    other_loads = [np.take_along_axis(*each, axis=1) for each in zip((lighter, heavier), best, strict=True)]
    start = ((here + 2 * amplitude) / p)[:, 0]  # the chord from no load, which needs no solution
    upper, lower = np.minimum(steepest.min(axis=1), start), np.maximum(shallowest.max(axis=1), 0)
    return (upper - lower) / np.maximum(lower, 1), np.hstack(other_loads)
