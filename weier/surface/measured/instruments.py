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


def read_lines(
    path: Path, layout: Mapping[str, Any], line: int | None, across: str | None, channel: int | str | None
) -> list[Line]:
    """Return the lines of a file: the one of a table of text, or the chosen lines of an instrument's file.

    Only `text` reads text: another reader might skip lines without a message.
    """
    try:
        table = read_columns(path, **layout)
    except NotTextError as error:
        if any(value is not None for value in layout.values()):
            raise ValueError(f"{error}; {', '.join(layout)} are of text: leave them out") from None
        topography, sized = _read_once(path.resolve(), sha256(path.read_bytes()).digest(), channel, str(error))
        return list(topography_lines(topography, line, across, sized))
    if (line, across, channel) != (None, None, None):
        raise ValueError(
            f"{path} is text, and line, across and channel are of maps of instruments: say columns= for the column "
            "of the heights, or take weier.Trace.of(SurfaceTopography.read_topography(...), line=...)"
        )
    return [table]


class ChannelError(ValueError):
    """Raised if a file lacks a channel, if the channel holds no heights, or if the file is text."""


@lru_cache(maxsize=1)  # Each line of a map is read by a call of its own.
def _read_once(path: Path, digest: bytes, channel: int | str | None, why_not_text: str) -> tuple[Any, bool]:
    """Return one channel of heights of a file with this digest, and whether the file has its lateral size.

    Raises
    ------
    ValueError
        If SurfaceTopography is not there or cannot read the file; the message begins with `why_not_text`.
    """
    try:
        from SurfaceTopography import open_topography
        from SurfaceTopography.Exceptions import ReadFileError
    except ModuleNotFoundError:
        raise ValueError(f"{why_not_text}; {INSTALL}") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # its readers name missing dependencies
            file = open_topography(str(path))
            if file.format() in TEXT_FORMATS:
                raise ChannelError(f"{why_not_text}; SurfaceTopography takes it for text, which it reads in part")
            if file.format() in FORMATS_WITHOUT_SIGNATURE and path.suffix.lower() != f".{file.format()}":
                raise ChannelError(f"{why_not_text}; SurfaceTopography does not know its format either")
            chosen = _channel(path, file.channels, channel)
            sized = chosen.physical_sizes is not None
            return chosen.topography(physical_sizes=None if sized else tuple(map(float, chosen.nb_grid_pts))), sized
    except (ChannelError, TimeoutError):  # these are a ValueError and an OSError
        raise
    except (ReadFileError, *READER_ERRORS) as error:
        raise ValueError(
            f"{why_not_text}; SurfaceTopography cannot read it either ({type(error).__name__})"
        ) from None


def topography_lines(topography: Any, line: int | None, across: str | None, sized: bool = True) -> Iterator[Line]:
    """Yield lines of heights of a topography: its only line, the chosen one, or all that run along an axis.

    Parameters
    ----------
    topography : object
        With `heights`, `physical_sizes`, `unit`, `is_periodic` and, where it is not uniform, `positions`, as those of
        SurfaceTopography.
    line : int, optional
        Number of the line of a map, from 0.
    across : "x" or "y", optional
        Axis along which the lines of a map run, across the grooves; without `line`, all lines.
    sized : bool
        Whether the sizes of the topography are known.

    Raises
    ------
    ValueError
        If a map is given without line or axis, or has no such line.
    """
    if not callable(getattr(topography, "heights", None)) or not hasattr(topography, "physical_sizes"):
        raise ValueError(f"topography must be one of SurfaceTopography, got {shown(topography)}")
    heights = np.ma.asarray(topography.heights())
    sizes = topography.physical_sizes if sized else None
    units = (length_unit(str(topography.unit)),) if topography.unit else ()
    periodic = bool(getattr(topography, "is_periodic", False))
    if heights.ndim == 1:
        if line is not None or across is not None:
            raise ValueError("line and across are of maps, and this is one line of heights: leave them out")
        even = getattr(topography, "is_uniform", True)
        positions = None if even else np.asarray(topography.positions())
        length = None if sizes is None or not even else float(sizes[0])
        yield Line(heights, positions, length, units, units, periodic)
        return
    shape = f"a map of {heights.shape[0]} by {heights.shape[1]} heights"
    if line is None and across is None:
        raise ValueError(f'{shape} has many lines: say line=0 for the first along x, or across="x" or "y" for all')
    axis = AXES.index(checked_word("across", "x" if across is None else across, AXES))
    along = heights if axis == 1 else heights.T  # rows are the lines
    numbers = range(len(along)) if line is None else [checked_count("line", line, 0, len(along) - 1)]
    for number in numbers:
        length = None if sizes is None else float(sizes[axis])
        yield Line(along[number], None, length, units, units, periodic, AXES[axis], number)


def _channel(path: Path, channels: Any, wanted: int | str | None) -> Any:
    """Return the channel of this number or name; else the first one of heights."""
    names = [channel.name for channel in channels]
    is_height = [getattr(channel, "is_height_channel", True) for channel in channels]
    if wanted is None:
        if not any(is_height):
            raise ChannelError(f"{path} has no channel of heights, only {', '.join(names) or 'none'}")
        return channels[is_height.index(True)]
    if wanted not in (names if isinstance(wanted, str) else range(len(channels))):
        raise ChannelError(f"channel must be one of {', '.join(names)}, or a number from 0, got {shown(wanted)}")
    number = names.index(wanted) if isinstance(wanted, str) else int(wanted)
    if not is_height[number]:
        raise ChannelError(f"channel must have heights, got {names[number]}, which has none")
    return channels[number]
