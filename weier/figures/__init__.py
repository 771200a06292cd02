"""Figures: each kind is one module of this folder, drawn in the style of `weier.figures.style`.

A module is a kind of figure if it has a CAPTION; its `draw(studies, title)` returns the figure. If draw also takes
`grouping`, a scene may say which parameter sets the colour, the panel and so on. Figures may use data, theory,
methods, scene, pipeline and accuracy, but not the command line.

The constants of the modules are read from their text, so that the kinds can be listed without importing matplotlib,
which takes longer than all the rest.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Sequence
from contextlib import ExitStack
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from weier.data.files import replacing
from weier.scene import BY_DEFAULT, Axis, Grouping
from weier.scene.figure import FREE

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from weier.theory.conduction import Interface

MAX_PANELS = 4  # in one column: more would not fit a page

# Files carry no dates, so that the same data give the same bytes.
METADATA: dict[str, dict[str, Any]] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}


class FigureKind(NamedTuple):
    """A kind of figure, as the constants of its module describe it.

    caption : CAPTION, in plain text; {methods} stands for the sentence that tells the curves of methods apart
    command : COMMAND, for a figure of one file that this command writes; empty for a figure of a scene's studies
    variable : VARIABLE, which the files of that command have
    needs : NEEDS, a key of the scene that must be true
    grouped : whether a scene may say by which parameters it is drawn
    units : whether it can be drawn in SI units
    needs_studies : whether it shows studies at all
    """

    caption: str
    command: str = ""
    variable: str = ""
    needs: str = ""
    grouped: bool = False
    units: bool = False
    needs_studies: bool = True


def kinds() -> dict[str, FigureKind]:
    """All kinds of figures, by the names of their modules."""
    texts = {path.stem: path.read_text(encoding="utf-8") for folder in __path__ for path in Path(folder).glob("*.py")}
    return {name: kind for name, text in sorted(texts.items()) if (kind := _kind(text))}


@cache  # a scene asks for the caption of each of its figures
def _kind(module: str) -> FigureKind | None:
    """The kind of figure that a module of this text draws, if it draws any."""
    tree, names = ast.parse(module), ("CAPTION", "COMMAND", "VARIABLE", "NEEDS")
    assigned = {ast.unparse(each.targets[0]): each.value for each in tree.body if isinstance(each, ast.Assign)}
    constants: list[Any] = [ast.literal_eval(assigned[name]) if name in assigned else "" for name in names]
    drawn = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    keywords = (name in drawn for name in ("grouping", "interface", "studies"))
    return FigureKind(*constants, *keywords) if "CAPTION" in assigned else None


def draw(
    kind: str,
    studies: Sequence[xr.Dataset],
    title: str,
    path: str | Path,
    grouping: Grouping = BY_DEFAULT,
    x: Axis = FREE,
    y: Axis = FREE,
    size: tuple[float, float] | None = None,
    interface: Interface | None = None,
    formats: Collection[str] = tuple(METADATA),
) -> None:
    """Draw one figure, in several formats beside each other.

    Parameters
    ----------
    kind : str
        One of `kinds()`.
    studies : sequence of Dataset
        What the figure shows, over case, solution_method, mean_pressure and term.
    title : str
        One line over the figure; empty for none.
    path : path
        Where to write: its suffix is replaced by those of the formats.
    grouping : Grouping
        By which parameters to draw, for a kind that is `grouped`.
    x, y : Axis
        Scales and ends of the axes of all panels, where they are not those of the kind.
    size : tuple of float, optional
        Width and height in inches.
    interface : Interface, optional
        The bodies by which the axes, and the ends of x and y, are in SI units, for a kind that has `units`. Curves of
        a trace are in units of its own length and height, whatever lambda_0 and g_0 the interface has.
    formats : collection of str
        Some of pdf, svg and png.

    Raises
    ------
    ValueError
        If there is no such kind, the studies are of another kind, or they hold nothing that it could show.

    """
    _check_studies(kind, studies)
    import matplotlib.style

    from weier.figures.style import SHEET, set_axes

    # The reset keeps the user's own matplotlibrc out of the figure.
    wanted: dict[str, Any] = {} if grouping == BY_DEFAULT else {"grouping": grouping}
    wanted |= {"interface": interface} if interface else {}
    with matplotlib.style.context(SHEET, after_reset=True):
        figure = import_module(f"weier.figures.{kind}").draw(studies, title, **wanted)
        set_axes(figure, x, y)
        if size:
            figure.set_size_inches(*size)
        save(figure, path, formats)


def _check_studies(kind: str, studies: Sequence[xr.Dataset]) -> None:
    known = kinds()
    if kind not in known:
        raise ValueError(f"there is no figure {kind!r}: choose from {', '.join(known)}")
    if known[kind].command and [known[kind].variable in study for study in studies] != [True]:
        raise ValueError(f"the figure {kind} is drawn from one file, that of `weier {known[kind].command}`")


def save(figure: Figure, path: str | Path, formats: Collection[str] = tuple(METADATA)) -> None:
    """Save a figure in the style that is set, in several formats beside each other."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure)  # measures texts, of which each takes milliseconds, once for the layout and for PNG
    if engine := figure.get_layout_engine():
        engine.execute(figure)
    figure.set_layout_engine(None)  # it is laid out by now: with any engine, saving would draw twice for each format
    with ExitStack() as stack:
        for suffix in formats:
            file = stack.enter_context(replacing(Path(path).with_suffix(f".{suffix}")))
            figure.savefig(file, format=suffix, metadata=METADATA[suffix])
