"""The description of a figure in a scene: its kind, its studies and its style."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from weier.data.bodies import Bodies

PHASES = ("phases", "seed")  # Profiles of the same D, gamma and m differ in one of these.
MAX_PANELS = 4  # A column of more panels does not fit on a page.


class Grouping(NamedTuple):
    """The parameters of a sweep that a figure shows by colour, panel and median; empty for its default.

    colour : the parameter shown by colour
    facet : the parameter shown by panels, or two for the rows and the columns of panels
    median_over : the parameters over which a median is drawn, in a band
    """

    colour: str = ""
    facet: tuple[str, ...] = ()
    median_over: tuple[str, ...] = ()

    def with_defaults(self, cases: int) -> Grouping:
        """Return the grouping; without one, few cases get a panel each, and many a median over phases."""
        if self != BY_DEFAULT:
            return self
        return EACH_CASE if cases <= MAX_PANELS else MEDIAN_OVER_PHASES

    def hidden(self, varying: Iterable[str]) -> str:
        """Return a sentence if parameters vary without being shown, else an empty text; methods are always shown."""
        shown = {self.colour, *self.facet, *self.median_over, "method"}
        if shown.intersection(PHASES):
            shown |= {*PHASES}
        hidden = [name for name in varying if name not in shown]
        if not hidden or self.facet == EACH_CASE.facet:
            return ""
        verb = "varies" if len(hidden) == 1 else "vary"
        ways = f"add {hidden[0]} to colour, facet or median over, or draw fewer cases"
        return f"{' and '.join(hidden)} {verb} among the curves and nothing shows it: {ways}"


BY_DEFAULT = Grouping()
EACH_CASE, MEDIAN_OVER_PHASES = Grouping(facet=("case",)), Grouping(median_over=PHASES)


class Figure(NamedTuple):
    """The kind of a figure (a module of weier.figures), its studies, and its parameters.

    behind : studies whose curves are a band behind the others
    x : scale of the axis of loads, "log" or "linear"; empty for the default of the figure
    interface : the bodies that convert values under loads in Pa into SI units; None for normalised axes
    """

    draw: str
    studies: tuple[str, ...] = ()
    title: str = ""
    grouping: Grouping = BY_DEFAULT
    behind: tuple[str, ...] = ()
    x: str = ""
    interface: Bodies | None = None

    @property
    def all_studies(self) -> tuple[str, ...]:
        """The studies shown, then those behind them."""
        return (*self.studies, *self.behind)
