"""What a scene says of a figure: what it draws, from which studies, and how."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from weier.theory.conduction import Interface

PHASES = ("phases", "seed")  # names of what differs between profiles of the same D, gamma and m


MAX_PANELS = 4  # in one column: more would not fit a page


class Grouping(NamedTuple):
    """Which parameters of a sweep a figure shows, and how; none where the figure chooses.

    colour : the parameter that sets the colour
    facet : the parameter that each panel has a value of, or two: that of each row of panels and of each column
    median_over : over which a median is drawn, with a band that holds all curves
    """

    colour: str = ""
    facet: tuple[str, ...] = ()
    median_over: tuple[str, ...] = ()

    def of(self, cases: int) -> Grouping:
        """By what so many cases are drawn: each has a panel, or more a median over phases, unless one is named."""
        return self if self != BY_DEFAULT else EACH_CASE if cases <= MAX_PANELS else MEDIAN_OVER_PHASES

    def hidden(self, varying: Iterable[str]) -> list[str]:
        """Which of the parameters that vary among the curves no key shows; a method always has a line of its own."""
        shown = {self.colour, *self.facet, *self.median_over, "method"}
        if shown.intersection(PHASES):
            shown |= {*PHASES}
        return [name for name in varying if name not in shown and self != EACH_CASE]

    def proposal(self, hidden: Sequence[str]) -> str:
        """A sentence that proposes how to show the parameters that are hidden."""
        first, *others = self.facet or ("",)
        facet = f"facet: [{first}, {hidden[0]}]" if first else f"facet: {hidden[0]}"
        free = [f"colour: {hidden[0]}"] * (not self.colour) + [facet] * (not others)
        keys = " or ".join(f"`{key}`" for key in [*free, f"median over: {hidden[0]}"])
        verb = "varies" if len(hidden) == 1 else "vary"
        return f"{' and '.join(hidden)} {verb} among the curves and nothing shows it: add {keys}, or draw fewer cases"


BY_DEFAULT = Grouping()
EACH_CASE, MEDIAN_OVER_PHASES = Grouping(facet=("case",)), Grouping(median_over=PHASES)


class Axis(NamedTuple):
    """The scale of an axis, "log" or "linear", and its ends; empty and None where the figure chooses."""

    scale: str = ""
    low: float | None = None
    high: float | None = None


FREE = Axis()


class Figure(NamedTuple):
    """What a figure draws (a module of weier.figures), from which studies, and by which parameters.

    x, y : its axes
    size : width and height in inches; None where the figure chooses
    interface : the bodies by which its axes are in SI units; None where they are normalised
    """

    draw: str
    studies: tuple[str, ...] = ()
    title: str = ""
    grouping: Grouping = BY_DEFAULT
    x: Axis = FREE
    y: Axis = FREE
    size: tuple[float, float] | None = None
    interface: Interface | None = None
