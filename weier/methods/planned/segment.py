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
    chord_loads : of each load, others to be solved with it, shape (loads, others), in p_0*: the chords to them bound
        the resistance; none of them where the method knows its own error
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
    chord_loads: Array | None = None

    @property
    def error(self) -> Array:
        """All errors together."""
        return self.truncation + self.discretisation + self.estimate

    @property
    def seconds(self) -> float:
        """Expected seconds on one core."""
        return self.seconds_start + float(self.seconds_load.sum())

    def fails_like(self, other: Part) -> bool:
        """Whether this will not do where the other did not: the same, or chords of no more terms."""
        if self.chord_loads is not None and other.chord_loads is not None:
            return self.terms <= other.terms
        return (self.method, self.terms) == (other.method, other.terms)

    def at(self, loads: slice) -> Part:
        """The same for some of its loads."""
        names = ("mean_pressure", "truncation", "discretisation", "estimate", "seconds_load")
        chords = None if self.chord_loads is None else self.chord_loads[loads]
        return self._replace(chord_loads=chords, **{name: getattr(self, name)[loads] for name in names})
