"""Lines of heights with their units, from files of instruments and from objects of SurfaceTopography.

SurfaceTopography reads some forty formats. It is an extra, which is imported when the first such file is read.
"""

from __future__ import annotations

import struct
import warnings
import zlib
from collections.abc import Iterator, Mapping
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from weier.checks import checked_count, checked_word, shown
from weier.surface.measured.lines import Line, length_unit
from weier.surface.measured.text import NotTextError, read_columns

INSTALL = "to read the formats of instruments, pip install 'weier[instruments]'"
TEXT_FORMATS = ("asc", "xyz")  # text formats of SurfaceTopography
FORMATS_WITHOUT_SIGNATURE = ("nms", "hgt")  # it takes any bytes for these formats
AXES = ("x", "y")  # axes of a map, in the order of its array
# Its readers raise these for a damaged file, besides ReadFileError.
READER_ERRORS = (
    *(ArithmeticError, AssertionError, AttributeError, EOFError, LookupError, OSError, RuntimeError),
    *(SyntaxError, TypeError, ValueError, BadZipFile, struct.error, zlib.error),
)


def read_lines(path: Path, layout: Mapping[str, Any], line: int | None, across: str | None) -> list[Line]:
    """Return the lines of a file: the one of a table of text, or the chosen lines of an instrument's file.

    Only `text` reads text: another reader might skip lines without a message.
    """
    try:
        table = read_columns(path, **layout)
    except NotTextError as error:
        if any(value is not None for value in layout.values()):
            raise ValueError(f"{error}; {', '.join(layout)} are of text: leave them out") from None
        topography, sized = _read_once(path.resolve(), sha256(path.read_bytes()).digest(), str(error))
        return list(topography_lines(topography, line, across, sized))
    if (line, across) != (None, None):
        raise ValueError(
            f"{path} is text, and line and across are of maps of instruments: say columns= for the column of the "
            "heights, or take weier.Trace.of(SurfaceTopography.read_topography(...), line=...)"
        )
    return [table]


@lru_cache(maxsize=1)  # Each line of a map is read by a call of its own.
def _read_once(path: Path, digest: bytes, why_not_text: str) -> tuple[Any, bool]:
    """Return the first channel of heights of a file with this digest, and whether the file has its lateral size."""
    try:
        from SurfaceTopography import open_topography
        from SurfaceTopography.Exceptions import ReadFileError
    except ModuleNotFoundError:
        raise ValueError(f"{why_not_text}; {INSTALL}") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # its readers name missing dependencies
            file = open_topography(str(path))
            kind, channels = file.format(), file.channels
            is_known = kind not in FORMATS_WITHOUT_SIGNATURE or path.suffix.lower() == f".{kind}"
            heights = [channel for channel in channels if getattr(channel, "is_height_channel", True)]
            if heights and is_known and kind not in TEXT_FORMATS:
                sizes = heights[0].physical_sizes
                given = tuple(map(float, heights[0].nb_grid_pts)) if sizes is None else None
                return heights[0].topography(physical_sizes=given), sizes is not None
    except TimeoutError:  # an OSError
        raise
    except (ReadFileError, *READER_ERRORS) as error:
        raise ValueError(
            f"{why_not_text}; SurfaceTopography cannot read it either ({type(error).__name__})"
        ) from None
    raise ValueError(f"{why_not_text}; SurfaceTopography finds no map of heights in it, and takes it for {kind}")


def topography_lines(topography: Any, line: int | None, across: str | None, sized: bool = True) -> Iterator[Line]:
    """Yield lines of heights of a topography: its only line, the chosen one, or all that run along an axis.

    `sized` tells whether the sizes of the topography are known.
    """
    if not callable(getattr(topography, "heights", None)) or not hasattr(topography, "physical_sizes"):
        raise ValueError(f"topography must be one of SurfaceTopography, got {shown(topography)}")
    heights = np.ma.asarray(topography.heights())
    sizes = topography.physical_sizes if sized else None
    unit = length_unit(str(topography.unit or ""))
    periodic = bool(getattr(topography, "is_periodic", False))
    if heights.ndim == 1:
        if line is not None or across is not None:
            raise ValueError("line and across are of maps, and this is one line of heights: leave them out")
        even = getattr(topography, "is_uniform", True)
        positions = None if even else np.asarray(topography.positions())
        length = None if sizes is None or not even else float(sizes[0])
        yield Line(heights, positions, length, unit, unit, periodic)
        return
    shape = f"a map of {heights.shape[0]} by {heights.shape[1]} heights"
    if line is None and across is None:
        raise ValueError(f'{shape} has many lines: say line=0 for the first along x, or across="x" or "y" for all')
    axis = AXES.index(checked_word("across", "x" if across is None else across, AXES))
    along = heights if axis == 1 else heights.T  # rows are the lines
    numbers = range(len(along)) if line is None else [checked_count("line", line, 0, len(along) - 1)]
    for number in numbers:
        length = None if sizes is None else float(sizes[axis])
        yield Line(along[number], None, length, unit, unit, periodic, AXES[axis], number)
