"""What a plan asks of a method, and the segments of a curve that the method offers in return."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.theory.profile import Profile

COMPLIANCE, RESISTANCE = QUANTITIES = ("compliance", "resistance")


class Task(NamedTuple):
    """What a plan asks of a method: the curve of a series within a tolerance.

    profile : the series to be modelled: the whole one, or a truncated one that may stand for it
    mean_pressure : loads, shape (loads,), increasing, in p_0*
    truncation : what the terms left out may change at each load, by the bounds theorem; 0 for the whole series
    tolerance : what is left for the method: of the compliance, in g_0; of the resistance, relative to the larger of
        itself and 1 g_0/p_0*
    quantity : "compliance" or "resistance"
    contacts : contacts to expect at each load
    first_contact : a bound above the compliance at first contact, in g_0
    """

    profile: Profile
    mean_pressure: Array
    truncation: Array
    tolerance: float
    quantity: str
    contacts: Array
    first_contact: float


class SegmentSolution(NamedTuple):
    """What running a segment gives, in the datum of the terms modelled; each of shape (loads,).

    compliance, resistance : in g_0 and g_0/p_0*
    compliance_error, resistance_error : expected, in the same units; inf where unknown
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array


class Segment(NamedTuple):
    """A range of loads and how it is solved; arrays over its loads.

    mean_pressure : in p_0*
    method : its name, or "full contact"
    terms : of the series, that are modelled
    settings : of the method, as keywords of weier.solve
    truncation : by the bounds theorem, what the terms not modelled may change
    discretisation : by the measured error model of a numerical method
    estimate : by the measured error model of an estimate
    seconds_start, seconds_load : expected
    memory : expected, in bytes
    why : in a sentence
    solve : from loads to their solution
    includes_tail : whether the method answers for the infinite or longer series, not for its terms alone
    other_loads : of each load, others to be solved with it, shape (loads, others), in p_0*: they tell how far the
        resistance may be off; none where the method knows by itself
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
    solve: Callable[[Array], SegmentSolution]
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

    def fails_like(self, other: Segment) -> bool:
        """Whether this will not do where the other did not: the same, or chords from no more terms."""
        if self.other_loads.size and other.other_loads.size:
            return self.terms <= other.terms
        return (self.method, self.terms, self.settings) == (other.method, other.terms, other.settings)

    def at(self, loads: slice) -> Segment:
        """What is left of the segment at some of its loads."""
        names = ("mean_pressure", "truncation", "discretisation", "estimate", "seconds_load", "other_loads")
        return self._replace(**{name: getattr(self, name)[loads] for name in names})


def make_segment(
    task: Task, method: str, why: str, solve: Callable[[Array], SegmentSolution], **known: Any
) -> Segment:
    """A segment over all loads of a task; what is not known of it is no error and no cost."""
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
    return Segment(task.mean_pressure, method, why=why, solve=solve, **{**fields, **known})
