"""The truncated series that may stand for the whole one, and the errors by the terms that they leave out.

The formulas are those of docs/planned.md, "What is offered"; docs/closed_forms.md, "Bounds on the terms left out",
proves them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem.error_model import MAX_POINTS, MIN_MEASURED_POINTS
from weier.methods.plan_part import COMPLIANCE, Task
from weier.methods.planned import forecast
from weier.surface.profile import Profile, terms_within

MAX_LENGTHS = 4  # So many numbers of terms are compared, from the fewest whose tail the tolerance allows.
# Error that a method may have where chords bound the resistance, over the amplitude left out.
METHOD_FRACTION = 0.1
# Chords lead to loads that are lighter by these fractions, and to the loads that are heavier by them.
LOAD_FRACTIONS = np.geomspace(1e-6, 0.999, 120)
MAX_LOAD = 1e300  # p_0*; heavier loads count as this, ten times which is still a finite number.


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

    A concave curve lies below its tangents: the chords to two more loads, a lighter and a heavier one, bound the
    slope at each load. The bounds become narrower as more terms are resolved. How many a load needs depends on it.
    """
    for terms in lengths:
        kept, amplitude = profile.truncated(terms), profile.amplitude_beyond(terms)
        error = METHOD_FRACTION * amplitude
        width, other_loads = expected_chords(kept, loads, amplitude + error)
        contacts = forecast.contacts(kept, loads)
        yield Task(kept, loads, width, error, COMPLIANCE, contacts, np.inf), other_loads


def expected_chords(kept: Profile, loads: Array, amplitude: float) -> tuple[Array, Array]:
    """The expected width between the best chords, over the larger of the resistance and 1, and their other loads.

    It follows from the curve of the layer model, for each load by itself.
    """
    p = np.minimum(loads, MAX_LOAD)[:, None]
    here, lighter, heavier = forecast.compliance(kept, p), p * (1 - LOAD_FRACTIONS), p / (1 - LOAD_FRACTIONS)
    steepest = (here - forecast.compliance(kept, lighter) + 2 * amplitude) / (p - lighter)
    shallowest = (forecast.compliance(kept, heavier) - here - 2 * amplitude) / (heavier - p)
    best = steepest.argmin(axis=1, keepdims=True), shallowest.argmax(axis=1, keepdims=True)
    other_loads = [np.take_along_axis(*side, axis=1) for side in zip((lighter, heavier), best, strict=True)]
    start = ((here + 2 * amplitude) / p)[:, 0]  # The chord from no load needs no solution.
    upper, lower = np.minimum(steepest.min(axis=1), start), np.maximum(shallowest.max(axis=1), 0)
    return (upper - lower) / np.maximum(lower, 1), np.hstack(other_loads)
