"""The candidates of a plan: full contact, and parts that methods offer for the whole series or a truncated one.

They are those of docs/planned.md, "What is offered".
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.method import Method
from weier.methods.plan_part import COMPLIANCE, PartSolution, PlanPart, Task, make_part
from weier.methods.planned import forecast
from weier.methods.planned.truncations import chord_tasks, resolvable_lengths, truncation_tasks
from weier.surface.profile import Profile

FULL_CONTACT = "full contact"


def candidates(
    profile: Profile, loads: Array, tolerance: float, quantity: str, methods: Sequence[Method]
) -> Iterator[PlanPart]:
    """All candidates, each at its cheapest setting; their error is infinite at loads where they do not apply."""
    lengths = resolvable_lengths(profile)
    first = forecast.first_contact(profile, lengths) if quantity == COMPLIANCE else math.inf
    contacts = forecast.contacts(profile, loads) if profile.m in lengths else np.full(loads.size, np.inf)
    of_series = Task(profile, loads, np.zeros(loads.size), tolerance, quantity, contacts, first)
    yield from _full_contact(of_series, lengths)
    yield from _offers(of_series, methods)
    if quantity == COMPLIANCE:
        for task in truncation_tasks(profile, loads, tolerance, lengths, first):
            yield from _offers(task, methods)
    elif profile.m not in lengths:  # Chords are wide, so that all terms are better where they can be resolved.
        for task, other_loads in chord_tasks(profile, loads, lengths):
            for offer in _offers(task, methods):
                yield _with_chords(offer, other_loads)


def _offers(task: Task, methods: Sequence[Method]) -> Iterator[PlanPart]:
    for method in methods:
        if method.takes(task.profile):
            yield from method.candidates(task)


def _full_contact(task: Task, lengths: Sequence[int]) -> Iterator[PlanPart]:
    """Full contact of the terms that the tolerance needs: closed form, free."""
    profile, loads = task.profile, task.mean_pressure
    finite = [] if math.isinf(profile.m) else [int(profile.m)]
    few = [terms for terms in lengths if profile.amplitude_beyond(terms) / 2 <= task.tolerance][:1]
    for terms in {*finite, *few} if task.quantity == COMPLIANCE else finite:
        kept, change = profile.truncated(terms), profile.amplitude_beyond(terms) / 2
        load = forecast.full_contact_load(kept)
        what = "finer terms change h by half of their height at most" if change else "nothing is left to flatten"
        yield make_part(
            task,
            FULL_CONTACT,
            f"from {load:.3g} p_0* on these terms are flat, and {what}",
            partial(_full_contact_solution, kept),
            terms=terms,
            truncation=np.where(loads >= load, change, np.inf),
        )


def _full_contact_solution(kept: Profile, loads: Array) -> PartSolution:
    none = np.zeros(loads.size)
    return PartSolution(none + kept.total_amplitude, none, none, none)


def _with_chords(offer: PlanPart, other_loads: Array) -> PlanPart:
    """A candidate with other loads solved beside each load; its own error is allowed for in that of the chords."""
    return offer._replace(
        discretisation=np.where(np.isfinite(offer.discretisation), 0.0, np.inf),
        other_loads=other_loads,
        seconds_load=(1 + other_loads.shape[1]) * offer.seconds_load,
        why=f"{offer.why}; chords to a lighter and a heavier load bound the resistance of the longer series",
    )
