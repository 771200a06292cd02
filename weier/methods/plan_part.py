"""A plan's task for the methods, and the parts of a plan that they offer as candidates.

They are those of docs/planned.md, "What is offered".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from weier.data.variables import QUANTITIES as QUANTITIES
from weier.kernels.arrays import Array
from weier.surface.profile import Profile

COMPLIANCE, RESISTANCE = QUANTITIES


class Task(NamedTuple):
    """The task of a plan for a method: the curve of a series within a tolerance.

    profile : the series to be modelled: the whole one, or a truncated one that may stand for it
    mean_pressure : loads, shape (loads,), increasing, in p_0*
    truncation : error by the terms left out at each load, by the bounds theorem; 0 for the whole series
    tolerance : the part of it that is left for the method: of the compliance, in g_0; of the resistance, relative to
        the larger of itself and 1 g_0/p_0*
    quantity : "compliance" or "resistance"
    contacts : expected number of contacts at each load
    first_contact : a bound above the compliance at first contact, in g_0
    """

    profile: Profile
    mean_pressure: Array
    truncation: Array
    tolerance: float
    quantity: str
    contacts: Array
    first_contact: float


class PartSolution(NamedTuple):
    """The solution of a plan part, in the datum of the terms modelled; arrays of shape (loads,).

    compliance, resistance : in g_0 and g_0/p_0*
    compliance_error, resistance_error : expected, in the same units; inf where unknown
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array


class PlanPart(NamedTuple):
    """A range of loads and how it is solved; arrays over its loads.

    mean_pressure : in p_0*
    method : its name, or "full contact"
    terms : of the series, that are modelled
    settings : of the method, as keywords of weier.solve
    truncation : error by the terms that are not modelled, by the bounds theorem
    discretisation : error by the measured error model of a numerical method
    estimate : error by the measured error model of an estimate
    seconds_start, seconds_load : expected
    memory : expected, in bytes
    why : the reason to take it, in a sentence
    solve : from loads to their solution
    includes_tail : whether the solution is that of the infinite or longer series, not of its terms alone
    other_loads : loads to be solved beside each load, shape (loads, others), in p_0*, whose chords bound the
        resistance; none where the method states an error of its own
    """

    mean_pressure: Array
    method: str
    terms: float
    settings: Mapping[str, Any]
    truncation: Array
    discretisation: Array
    estimate: Array
    seconds_start: float
    seconds_load: Array
    memory: float
    why: str
    solve: Callable[[Array], PartSolution]
    other_loads: Array
    includes_tail: bool = False

    @property
    def error(self) -> Array:
        """All errors together."""
        return self.truncation + self.discretisation + self.estimate

    @property
    def seconds(self) -> float:
        """Expected seconds to start and to solve all loads, on one core."""
        return self.seconds_start + float(self.seconds_load.sum())

    def fails_like(self, other: PlanPart) -> bool:
        """Whether this misses the tolerance where the other did: it is the same, or its chords have no more terms."""
        if self.other_loads.size and other.other_loads.size:
            return self.terms <= other.terms
        return (self.method, self.terms, self.settings) == (other.method, other.terms, other.settings)

    def at(self, loads: slice) -> PlanPart:
        """The part at some of its loads."""
        names = ("mean_pressure", "truncation", "discretisation", "estimate", "seconds_load", "other_loads")
        return self._replace(**{name: getattr(self, name)[loads] for name in names})


def make_part(task: Task, method: str, why: str, solve: Callable[[Array], PartSolution], **known: Any) -> PlanPart:
    """A part over all loads of a task; errors and costs that are not given are 0."""
    none = np.zeros(task.mean_pressure.size)
    fields: dict[str, Any] = {
        "terms": task.profile.m,
        "settings": {},
        "truncation": task.truncation,
        "discretisation": none,
        "estimate": none,
        "seconds_start": 0.0,
        "seconds_load": none,
        "memory": 0.0,
        "other_loads": np.empty((none.size, 0)),
    }
    return PlanPart(task.mean_pressure, method, why=why, solve=solve, **{**fields, **known})
