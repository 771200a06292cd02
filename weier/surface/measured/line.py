"""One line of measured heights, from a file, an array or a topography."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from weier.surface.measured.length_units import length_unit
from weier.units import unit_of


class Line(NamedTuple):
    """Heights, with their positions and units as far as they are known.

    heights : array, shape (samples,); masked, NaN or None for missing heights
    positions : array, shape (samples,), along the line; None if it has none
    length : length of the line, the number of heights times the step; None if unknown
    x_units, height_units : the units that are named for positions and length, and for heights: none or more
    periodic : whether the surface is known to repeat
    axis, number : for a line of a map, the axis that it runs along and its number among these lines
    numbers : in a file of text, the number of the line of each height, from 1
    decimals : in a file of text, the number of decimals of the positions
    left_out : the lines of a file of text above and below its table
    """

    heights: Any
    positions: Any = None
    length: float | None = None
    x_units: tuple[str, ...] = ()
    height_units: tuple[str, ...] = ()
    periodic: bool = False
    axis: str = ""
    number: int | None = None
    numbers: tuple[int, ...] = ()
    decimals: int | None = None
    left_out: tuple[str, ...] = ()

    def place(self, at: int) -> str:
        """Return the place of the height of this index, in words."""
        return f"height {at + 1}" + (f" in line {self.numbers[at]}" if self.numbers else "")

    def rising(self) -> Line:
        """Return the line in the order of rising positions, if they fall."""
        x = np.asarray([] if self.positions is None else self.positions, float)
        if x.ndim != 1 or x.size < 2 or not (np.diff(x) <= 0).all():
            return self
        return self._replace(heights=self.heights[::-1], positions=x[::-1], numbers=self.numbers[::-1])

    @property
    def name(self) -> str:
        """Label of the line in a map, as in "x 120"; empty if it is not from a map."""
        return f"{self.axis} {self.number}" if self.axis else ""


def line_from_array(heights: Any, with_positions: bool) -> Line:
    """Return the line of an array: one of xarray may have units, and a coordinate with positions.

    A coordinate without a unit is taken for a mere number of each height unless `with_positions`.
    """
    height_units = _units(heights)
    dims: tuple[Any, ...] = getattr(heights, "dims", ())
    if len(dims) != 1 or dims[0] not in getattr(heights, "coords", ()):
        return Line(heights, height_units=height_units)
    coordinate = heights.coords[dims[0]]
    x_units = _units(coordinate)
    known = bool(x_units) or with_positions
    return Line(heights, coordinate.values if known else None, None, x_units, height_units)


def _units(values: Any) -> tuple[str, ...]:
    unit = unit_of(values)
    return (length_unit(unit),) if unit else ()
