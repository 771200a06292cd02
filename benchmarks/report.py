"""The comparison as a Markdown table with ratios, and as a figure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.style
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from benchmarks.measure import failed, wrong
from benchmarks.problem import REFERENCE_TOLERANCE
from benchmarks.programs import PAIRS
from weier.data import markdown
from weier.figures import save, style

OURS = "weier"  # The program with which the others are compared.
HEIGHT = 2.0  # inches: the height of a panel.
# Lines of programs, and labels of axes.
LOOKS: dict[str, dict[str, Any]] = {
    "weier": {"color": style.BLACK, "linestyle": style.DASHES[0], "marker": "o"},
    "weier_default": {"color": style.GREEN, "linestyle": style.DASHES[3], "marker": "s"},
    "tamaas": {"color": style.VERMILLION, "linestyle": style.DASHES[1], "marker": "D"},
    "contact_mechanics": {"color": style.BLUE, "linestyle": style.DASHES[2], "marker": "^"},
    "slippy": {"color": style.ORANGE, "linestyle": style.DASHES[5], "marker": "x"},
    "dense": {"color": style.PURPLE, "linestyle": style.DASHES[4], "marker": "v"},
}
WORDS = {
    "points": "nodes $N$",
    "time": "processor time for a curve (s)",
    "pairs": "FFT pairs a load",
    "error": "largest error of $h/g_0$",
}


def least_seconds(data: xr.Dataset) -> xr.DataArray:
    """Return processor seconds of each program on each grid, the minimum over its runs."""
    return data["seconds"].min("repeat")


def table(data: xr.Dataset) -> str:
    """Return the comparison as Markdown: seconds of each program, their ratio to weier, and errors."""
    head = ("N", "program", "seconds", f"times {OURS}", "work a load", "residual", "error of h", "loads wrong")
    rows = []
    for points in data["points"].values:
        for program in data["program"].values:
            row = data.sel({"program": program, "points": points})
            if row["seconds"].notnull().any():
                rows.append(_cells(data, row))
    figure = "![Time and pairs of FFTs over the number of nodes, and error over time](benchmark.png)"
    return "\n".join([*_preface(data), "", markdown.table(head, rows), "", figure, ""])


def _cells(data: xr.Dataset, row: xr.Dataset) -> list[str]:
    at = {"program": row["program"], "points": row["points"]}
    ours = (
        float(least_seconds(data).sel({"program": OURS, "points": row["points"]}))
        if OURS in data["program"].values
        else np.nan
    )
    own = float(least_seconds(data).sel(at))
    wrong_count, failed_count = int(wrong(data).sel(at)), int(failed(data).sel(at))
    faults = [f"{wrong_count} reported as converged"] * (wrong_count > 0)
    faults += [f"{failed_count} not converged"] * (failed_count > 0)
    return [
        f"{int(row['points'])}",
        markdown.plain(str(row["label"].values)),
        f"{own:.3g}",
        f"{own / ours:.3g}",
        f"{float(row['work'].mean()):.3g} {row['work_unit'].values}",
        f"{float(row['residual'].max()):.1e}",
        f"{float(row['error']):.1e}",
        ", ".join(faults) or "0",
    ]


def _preface(data: xr.Dataset) -> list[str]:
    attributes, loads = data.attrs, data["mean_pressure"].values
    return [
        "# Benchmarks",
        "",
        "## On the same grid",
        "",
        f"`python -m benchmarks same_grid` solves one profile under the same loads with several programs: "
        f"{loads.size} loads in [{loads[0]:.3g}, {loads[-1]:.3g}] p_0*, D = {attributes['D']:g}, "
        f"gamma = {attributes['gamma']}, m = {attributes['m']}. "
        f"{attributes['machine']}; one thread; {attributes['packages']}.",
        "",
        f"Seconds are processor time for the whole curve, the least of {data.sizes['repeat']} runs taken in turn. "
        "The other programs and the dense inversion start each load from the next heavier one; weier solves each "
        "load independently. With the staircase kept, edges of contact are on nodes and the compliance is the only "
        "result, as with the other programs. With the staircase removed, the default, the results include the "
        "resistance and bounds on both errors.",
        "",
        f"Every program must reach a residual of {attributes['tolerance']:.0e} g_0: the largest |gap| under pressure "
        "or penetration elsewhere, from the returned pressure and a freshly applied operator. weier, slippy and the "
        "dense inversion take piecewise-linear pressure, tamaas and ContactMechanics trigonometric pressure (the "
        "Fourier kernel 1/|k|): each residual is that of its own discretisation. The tolerances of the other "
        "programs are, load by load, the loosest that reach this residual. Work is counted in pairs of FFTs, "
        "weighted by size on coarser grids, or in dense solutions.",
        "",
        "Errors of h, in g_0, are the largest over the loads, against the method `patches` at a tolerance of "
        f"{REFERENCE_TOLERANCE:g} g_0, which took {attributes['reference_seconds']:.3g} s for the same curve.",
    ]


def draw(data: xr.Dataset, path: Path) -> None:
    """Draw time and FFT pairs against N, and error against time, as PDF, SVG and PNG."""
    with matplotlib.style.context(style.SHEET, after_reset=True):
        figure, (time, pairs, accuracy) = style.column("", ["", "", ""], HEIGHT)
        data = data.assign(time=least_seconds(data), pairs=_pairs(data))
        _panel(time, data, "points", "time")
        _panel(pairs, data, "points", "pairs")
        _panel(accuracy, data, "time", "error")
        _mark_patches(accuracy, data)
        figure.legend(*time.get_legend_handles_labels(), loc="outside upper center", ncols=2, handlelength=3.2)
        save(figure, path)


def _pairs(data: xr.Dataset) -> xr.DataArray:
    return data["work"].mean("mean_pressure").where(data["work_unit"] == PAIRS)


def _panel(axes: Axes, data: xr.Dataset, x: str, y: str) -> None:
    """Draw a line for each program, with a marker for each size."""
    axes.set(xscale="log", yscale="log", xlabel=WORDS[x], ylabel=WORDS[y])
    if x == "points":
        axes.set_xscale("log", base=2)
    for program in data["program"].values:
        row = data.sel({"program": program})
        there = row[x].notnull() & row[y].notnull()
        if there.any():
            look = {**LOOKS[str(program)], "label": str(row["label"].values)}
            axes.plot(row[x].values[there], row[y].values[there], **look)


def _mark_patches(axes: Axes, data: xr.Dataset) -> None:
    """Mark the time that contact patches take for ten digits, which are off the scale of errors."""
    at = data.attrs["reference_seconds"]
    axes.axvline(at, color="0.5", linewidth=0.8, zorder=0)
    axes.annotate(
        "contact patches:\n1e-12 or less",
        (at, 0.05),
        (-4, 0),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        fontsize=6.5,
        ha="right",
        va="bottom",
        color="0.35",
    )
