"""Figures: each kind is one module of this folder, drawn in the style of `weier.figures.style`.

A module is a kind of figure if it has a CAPTION; its `draw(studies, title)` returns the figure. If draw also takes
`grouping`, a scene may choose the parameters of colours, panels and medians. This folder may import all others except
the command line.

The constants of the modules are read from their text, so that kinds can be listed without importing matplotlib.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from weier.api.rows import BOUNDS
from weier.data.files import replacing
from weier.scene import BY_DEFAULT, Figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib import figure

# Files carry no dates, so that the same data give the same bytes.
METADATA: dict[str, dict[str, Any]] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}
VALUES = "csv"  # a further format, the values of a figure

# Variables that no figure shows, and further ones that figures of grouped curves do not show: of a hundred thousand
# cases at 40 loads by four methods, each variable takes 128 MB.
UNDRAWN = ("indentation", "patch_count", "residual", "work", "points", "settings", "status", "origin")
UNGROUPED = (*BOUNDS, "contact_fraction", "contact_edge")


class FigureKind(NamedTuple):
    """A kind of figure, as the constants of its module describe it.

    caption : CAPTION, in plain text; {methods} is replaced by the sentence that distinguishes the methods
    command : COMMAND, for a figure of one file that this measurement writes; empty for a figure of a scene's studies
    variable : VARIABLE, which the files of that command have
    needs : NEEDS, a key of the scene that must be true
    grouped : whether a scene may choose its parameters, and whether it can be drawn in SI units
    needs_studies : whether it shows studies
    """

    caption: str
    command: str = ""
    variable: str = ""
    needs: str = ""
    grouped: bool = False
    needs_studies: bool = True


def kinds() -> dict[str, FigureKind]:
    """Return all kinds of figures by the names of their modules."""
    texts = {path.stem: path.read_text(encoding="utf-8") for folder in __path__ for path in Path(folder).glob("*.py")}
    return {name: _kind(text) for name, text in sorted(texts.items()) if "\nCAPTION = " in text}


@cache  # A scene needs the captions of all its figures.
def _kind(module: str) -> FigureKind:
    """Return the kind of figure of a module with this text."""
    tree, names = ast.parse(module), ("CAPTION", "COMMAND", "VARIABLE", "NEEDS")
    assigned = {
        ast.unparse(statement.targets[0]): statement.value
        for statement in tree.body
        if isinstance(statement, ast.Assign)
    }
    constants: list[Any] = [ast.literal_eval(assigned[name]) if name in assigned else "" for name in names]
    drawn = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    return FigureKind(*constants, *(name in drawn for name in ("grouping", "studies")))


def undrawn(kind: str) -> tuple[str, ...]:
    """Return the variables of curves that figures of a kind do not show."""
    found = kinds()
    grouped = kind in found and found[kind].grouped
    return UNDRAWN + tuple(name for name in UNGROUPED if grouped and name != kind)


def draw(
    wanted: Figure,
    studies: Sequence[xr.Dataset],
    path: str | Path,
    formats: Collection[str] = tuple(METADATA),
) -> None:
    """Draw one figure, in several formats.

    Parameters
    ----------
    wanted : weier.scene.Figure
        Description of the figure, one of `kinds()`. In SI units, curves of a trace have the scale of the trace in
        place of lambda_0 and g_0 of the interface.
    studies : sequence of Dataset
        Data over case, solution_method, mean_pressure and term, in the order of `wanted.all_studies`: normalised, but
        for the loads, which are in Pa if the figure has an interface.
    path : path
        Path of the files; its suffix is replaced by those of the formats.
    formats : collection of str
        Some of pdf, svg, png, and csv for the values.

    Raises
    ------
    ValueError
        If there is no such kind, or the studies do not contain what it shows.

    """
    import matplotlib.style

    from weier.figures.style import SHEET

    # The reset keeps the user's own matplotlibrc out of the figure.
    with matplotlib.style.context(SHEET, after_reset=True):
        save(_drawn(wanted, studies), path, formats)


def _drawn(wanted: Figure, studies: Sequence[xr.Dataset]) -> figure.Figure:
    """Return the figure in the current style; ValueError with the reason if it cannot be drawn."""
    known = kinds()
    if wanted.draw not in known:
        raise ValueError(f"there is no figure {wanted.draw!r}: choose from {', '.join(known)}")
    kind = known[wanted.draw]
    if kind.command and [kind.variable in study for study in studies] != [True]:
        raise ValueError(
            f"the figure {wanted.draw} is drawn from the file of `python -m weier.accuracy {kind.command}`"
        )
    from weier.figures.style import set_axes

    options: dict[str, Any] = {} if wanted.grouping == BY_DEFAULT else {"grouping": wanted.grouping}
    options |= {"interface": wanted.interface} if wanted.interface else {}
    shown = len(studies) - len(wanted.behind)
    options |= {"behind": studies[shown:]} if wanted.behind else {}
    drawn: figure.Figure = import_module(f"weier.figures.{wanted.draw}").draw(
        studies[:shown], wanted.title, **options
    )
    set_axes(drawn, wanted.x, wanted.y)
    if wanted.size:
        drawn.set_size_inches(*wanted.size)
    return drawn


def save(drawn: figure.Figure, path: str | Path, formats: Collection[str] = tuple(METADATA)) -> None:
    """Save a figure in the current style, in several formats; csv is its values."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from weier.figures.values import as_csv

    FigureCanvasAgg(drawn)  # One canvas caches the sizes of texts for the layout and for PNG.
    if engine := drawn.get_layout_engine():
        engine.execute(drawn)
    drawn.set_layout_engine(None)  # With a layout engine, each format would be drawn twice.
    for suffix in formats:
        with replacing(Path(path).with_suffix(f".{suffix}")) as file:
            if suffix == VALUES:
                file.write_text(as_csv(drawn), encoding="utf-8")
                continue
            drawn.savefig(file, format=suffix, metadata=METADATA[suffix])
