"""A part of a plan: some loads, what solves them, how far off and at what cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Part(NamedTuple):
    """A range of loads and how it is solved; arrays over its loads.

    mean_pressure : in p_0*
    method : "full contact", "westergaard", "demelio", "layer", "bem", "patches" or "endless"
    terms : of the series, that are modelled
    settings : of the method, as keywords of weier.solve
    truncation : by the bounds theorem, what the terms not modelled may change
    discretisation : by the measured laws, of a numerical method
    estimate : by the measured laws, of an estimate
    seconds_start, seconds_load : expected
    memory : expected, in bytes
    why : in a sentence
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
    whole: bool = False

    @property
    def error(self) -> Array:
        """All errors together."""
        return self.truncation + self.discretisation + self.estimate

    @property
    def seconds(self) -> float:
        """Expected seconds on one core."""
        return self.seconds_start + float(self.seconds_load.sum())

    def at(self, loads: slice) -> Part:
        """The same for some of its loads."""
        names = ("mean_pressure", "truncation", "discretisation", "estimate", "seconds_load")
        return self._replace(**{name: getattr(self, name)[loads] for name in names})
