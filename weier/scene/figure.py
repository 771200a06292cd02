"""The description of a figure in a scene: its kind, its studies and its style."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from weier.data.bodies import Bodies
from weier.kernels.arrays import Array

PHASES = ("phases", "seed")  # Profiles of the same D, gamma and m differ in one of these.
MAX_PANELS = 4  # A column of more panels does not fit on a page.


# The bands around medians: by default most curves, which does not widen with every case more.
PERCENTILES, ALL, MEAN = (10.0, 90.0), (0.0, 100.0), (-1.0, -1.0)


class Grouping(NamedTuple):
    """The parameters of a sweep that a figure shows by colour, panel and median; empty for its default.

    colour : the parameter shown by colour
    facet : the parameter shown by panels, or two for the rows and the columns of panels
    median_over : the parameters over which a median is drawn, in a band
    band : the percentiles between which the band lies, or MEAN for the mean and its standard error
    """

    colour: str = ""
    facet: tuple[str, ...] = ()
    median_over: tuple[str, ...] = ()
    band: tuple[float, float] = PERCENTILES

    def of(self, cases: int) -> Grouping:
        """Return the grouping; by default a panel for each of few cases, or a median over phases."""
        if self != BY_DEFAULT._replace(band=self.band):
            return self
        return (EACH_CASE if cases <= MAX_PANELS else MEDIAN_OVER_PHASES)._replace(band=self.band)

    def reduce(self, values: Array) -> Array:
        """Return the line and both ends of the band of curves of shape (curves, loads): shape (3, loads)."""
        if self.band == MEAN:
            mean, error = values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(len(values))
            return np.stack([mean, mean - error, mean + error])
        return np.percentile(values, [50, *self.band], axis=0)

    @property
    def line_name(self) -> str:
        """What the line is, in a word."""
        return "mean" if self.band == MEAN else "median"

    @property
    def band_name(self) -> str:
        """What the band holds, in words."""
        if self.band == MEAN:
            return "the standard error"
        low, high = self.band
        return "all" if self.band == ALL else f"{low:g} to {high:g} %"

    def hidden(self, varying: Iterable[str]) -> list[str]:
        """Return the parameters that vary among the curves without being shown; methods are always shown."""
        shown = {self.colour, *self.facet, *self.median_over, "method"}
        if shown.intersection(PHASES):
            shown |= {*PHASES}
        return [name for name in varying if name not in shown and self.facet != EACH_CASE.facet]

    def proposal(self, hidden: Sequence[str]) -> str:
        """Return a sentence that proposes how to show the parameters that are hidden."""
        first, *others = self.facet or ("",)
        facet = f"facet: [{first}, {hidden[0]}]" if first else f"facet: {hidden[0]}"
        free = [f"colour: {hidden[0]}"] * (not self.colour) + [facet] * (not others)
        keys = " or ".join(f"`{key}`" for key in [*free, f"median over: {hidden[0]}"])
        verb = "varies" if len(hidden) == 1 else "vary"
        return f"{' and '.join(hidden)} {verb} among the curves and nothing shows it: add {keys}, or draw fewer cases"


BY_DEFAULT = Grouping()
EACH_CASE, MEDIAN_OVER_PHASES = Grouping(facet=("case",)), Grouping(median_over=PHASES)


class Axis(NamedTuple):
    """The scale of an axis, "log" or "linear", and its ends; empty and None for the default of the figure."""

    scale: str = ""
    low: float | None = None
    high: float | None = None


FREE = Axis()


class Figure(NamedTuple):
    """The kind of a figure (a module of weier.figures), its studies, and its parameters.

    behind : studies whose curves are a band behind the others
    x, y : its axes
    size : width and height in inches; None for the default of the figure
    interface : the bodies that convert values under loads in Pa into SI units; None for normalised axes
    """

    draw: str
    studies: tuple[str, ...] = ()
    title: str = ""
    grouping: Grouping = BY_DEFAULT
    behind: tuple[str, ...] = ()
    x: Axis = FREE
    y: Axis = FREE
    size: tuple[float, float] | None = None
    interface: Bodies | None = None

    @property
    def all_studies(self) -> tuple[str, ...]:
        """The studies that it shows, and those behind them."""
        return (*self.studies, *self.behind)
