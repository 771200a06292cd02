"""Figures: modules of this folder draw them in the style of `weier.figures.style`.

`KINDS` lists the kinds of figures, so that matplotlib is not imported for their captions. `draw(studies, title)` of
the module of a kind returns the figure. This folder may import all others except the command line.
"""

from __future__ import annotations

import zlib
from collections.abc import Collection, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from weier.api.rows import BOUNDS
from weier.data.files import replacing
from weier.scene import BY_DEFAULT, Figure, Scene

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib import figure

# Files carry no dates, so that the same data give the same bytes. This strategy of
# compression takes two thirds of the time, and makes PNG files up to 15 % larger.
WRITTEN: dict[str, dict[str, Any]] = {
    "png": {"pil_kwargs": {"compress_type": zlib.Z_RLE}},
    "pdf": {"metadata": {"CreationDate": None}},
    "svg": {"metadata": {"Date": None}},
}
VALUES = "csv"  # suffix of the values of a figure

# Variables that no figure shows, and further ones that figures of grouped curves do not show: of a hundred thousand
# cases at 40 loads by four methods, each variable over loads takes 128 MB.
UNDRAWN = (
    *("indentation", "mean_gap", "patch_count", "residual", "work", "points", "settings", "status", "origin"),
    *("seconds", "first_contact", "area_coefficient", "rms_height", "rms_slope", "rms_curvature"),
)
UNGROUPED = (*BOUNDS, "contact_fraction", "contact_edge", "tail_amplitude")


class FigureKind(NamedTuple):
    """A kind of figure.

    caption : in plain text
    drawn_by, quantity : the drawing module, if it has another name, and the quantity passed to it
    needs : a key of the scene that must be true
    grouped : whether a scene may choose its parameters, and whether it can be drawn in SI units
    needs_studies : whether it shows studies
    """

    caption: str
    drawn_by: str = ""
    quantity: str = ""
    needs: str = ""
    grouped: bool = False
    needs_studies: bool = True


KINDS = {
    "borodich_galanov": FigureKind(
        "Bounds on the stiffness, hence on the conductance, of the self-similar punch of Borodich and Galanov over "
        "its roughness (Appendix B). They coincide for the smooth punch; the upper one is unbounded.",
        needs_studies=False,
    ),
    "compliance": FigureKind(
        "Compliance over mean pressure. All curves of one profile meet at full contact, where the compliance is the "
        "sum of the amplitudes of its waves, or the height of a trace.",
        "many_curves",
        "compliance",
        grouped=True,
    ),
    "contact_fraction": FigureKind(
        "Contact fraction, the contact area over the nominal area, over mean pressure.",
        "many_curves",
        "contact_fraction",
        grouped=True,
    ),
    "contact_tree": FigureKind(
        "The profile and, below it, its contacts over mean pressure. Contacts are born as points, grow, and merge "
        "until all are one.",
        needs="contact_edges",
    ),
    "message": FigureKind(
        "Contact fraction and resistance against the number of terms at three loads. Lines: medians over the "
        "phases by the most accurate method; bands: 10th to 90th percentile; bars at the right: bounds on the "
        "resistance of the infinite series (27), from the longest one. Not of the paper: the theory of 2000 "
        "(dashed, the contact fraction alone) and Persson's theory (dotted).",
    ),
    "phases": FigureKind(
        "The effect of the phase between the waves on the compliance over mean pressure. Dashed lines are single "
        "phases, from light (in phase) to dark (in antiphase); the solid line is their average. All curves meet at "
        "full contact.",
    ),
    "profiles": FigureKind("The profiles over two of their longest wavelengths."),
    "resistance": FigureKind(
        "Contact resistance over mean pressure. The exact curve drops steeply at the birth of a contact and has a "
        "kink where two merge.",
        "many_curves",
        "resistance",
        grouped=True,
    ),
    "truncated_compliance": FigureKind(
        "The effect of additional terms on the compliance, counted for all series from the undeformed infinite "
        "series whose waves all peak together, since the bounds compare mean gaps. The band contains the infinite "
        "series for any phases of its further terms (27).",
        "truncation",
        "compliance",
    ),
    "truncated_resistance": FigureKind(
        "The effect of additional terms on the contact resistance. The band contains the infinite series for any "
        "phases of its further terms.",
        "truncation",
        "resistance",
    ),
}


def undrawn(kind: str) -> tuple[str, ...]:
    """Return the variables that figures of a kind do not use."""
    grouped = kind in KINDS and KINDS[kind].grouped
    return UNDRAWN + tuple(name for name in UNGROUPED if grouped and name != kind)


def draw(
    wanted: Figure, studies: Sequence[xr.Dataset], path: str | Path, formats: Collection[str] = tuple(WRITTEN)
) -> None:
    """Draw one figure in several formats, which replace the suffix of the path; csv has its values.

    The studies are in the order of `wanted.all_studies`, in memory: normalised, except for loads in a unit of
    pressure if the figure has an interface. ValueError is raised if data are missing.
    """
    import matplotlib.style

    from weier.figures.style import SHEET

    # Resetting keeps the user's matplotlibrc out of the figure.
    with matplotlib.style.context(SHEET, after_reset=True):
        save(_drawn(wanted, studies), path, formats)


def _drawn(wanted: Figure, studies: Sequence[xr.Dataset]) -> figure.Figure:
    """Draw the figure in the current style; raise ValueError with the reason if this fails."""
    kind = KINDS[wanted.draw]
    from weier.figures.style import set_load_scale

    shown = len(studies) - len(wanted.behind)
    chosen = {"grouping": wanted.grouping, "interface": wanted.interface, "behind": studies[shown:]}
    options: dict[str, Any] = {name: value for name, value in chosen.items() if value and value != BY_DEFAULT}
    if kind.quantity:
        options["quantity"] = kind.quantity
    module = import_module(f"weier.figures.{kind.drawn_by or wanted.draw}")
    drawn: figure.Figure = module.draw(studies[:shown], wanted.title, **options)
    if wanted.x:
        set_load_scale(drawn, wanted.x)
    return drawn


def save(drawn: figure.Figure, path: str | Path, formats: Collection[str] = tuple(WRITTEN)) -> None:
    """Save a figure in the current style, in several formats; csv has its values."""
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
            drawn.savefig(file, format=suffix, **WRITTEN[suffix])


def caption(scene: Scene, name: str) -> str:
    """Return the caption of a figure of a scene, as plain text with the paper's symbols: its title and its kind's."""
    figure = scene.figure(name)
    text = KINDS[figure.draw].caption
    return f"{figure.title}. {text}" if figure.title else text
