"""What a plan asks of a method, and the segments of a curve that the method offers in return."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from weier.kernels.arrays import Array
from weier.theory.profile import Profile


class Truncation(NamedTuple):
    """A truncated series that may stand for the whole one.

    kept : its terms as a profile
    error : what the terms left out may change at each load, by the bounds theorem; inf where that is too much
    remaining : how much of the tolerance is left for the method
    contacts : contacts to expect at each load
    """

    kept: Profile
    error: Array
    remaining: float
    contacts: Array


class Task(NamedTuple):
    """What a plan is to reach.

    profile : the series, of any number of terms
    mean_pressure : loads, shape (loads,), increasing, in p_0*
    tolerance : of the compliance, in g_0; of the resistance, relative to the larger of itself and 1 g_0/p_0*
    quantity : "compliance" or "resistance"
    truncations : the truncated series that may stand for the profile
    """

    profile: Profile
    mean_pressure: Array
    tolerance: float
    quantity: str
    truncations: tuple[Truncation, ...]


class Solution(NamedTuple):
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
    method : its name
    terms : of the series, that are modelled
    settings : of the method, as keywords of weier.solve
    truncation : by the bounds theorem, what the terms not modelled may change
    discretisation : by the measured error model of a numerical method
    estimate : by the measured error model of an estimate
    seconds_start, seconds_load : expected
    memory : expected, in bytes
    why : in a sentence
    solve : from the loads to their solution
    whole : whether the method answers for the whole series, not for the terms alone
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
    solve: Callable[[Array], Solution]
    whole: bool = False

    @property
    def error(self) -> Array:
        """All errors together."""
        return self.truncation + self.discretisation + self.estimate

    @property
    def seconds(self) -> float:
        """Expected seconds on one core."""
        return self.seconds_start + float(self.seconds_load.sum())

    def at(self, loads: slice) -> Segment:
        """The same for some of its loads."""
        names = ("mean_pressure", "truncation", "discretisation", "estimate", "seconds_load")
        return self._replace(**{name: getattr(self, name)[loads] for name in names})
