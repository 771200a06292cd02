"""What the numbers say: a Markdown table with ratios, and a figure of two panels."""

from __future__ import annotations

from pathlib import Path

import matplotlib.style
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from benchmarks.measure import failed, wrong
from weier.figures import METADATA, style
from weier.files import replacing

OURS = "weier"
LOOKS = {
    "weier": style.Line("", style.BLACK, "-"),
    "weier_resistance": style.Line("", style.GREEN, style.DASHES[3]),
    "tamaas": style.Line("", style.VERMILLION, style.DASHES[1]),
    "contact_mechanics": style.Line("", style.BLUE, style.DASHES[2]),
    "dense": style.Line("", style.PURPLE, style.DASHES[4]),
}
MARKERS = dict(zip(LOOKS, "osD^v", strict=True))


def median(data: xr.Dataset) -> xr.DataArray:
    """Seconds of each method and size: the median of the repeats."""
    return data["seconds"].median("repeat")


def table(data: xr.Dataset) -> str:
    """The whole comparison as Markdown: who takes how long, times of ours, and whether the answer is right."""
    head = ("N", "program", "seconds", f"/ {OURS}", "work a load", "residual", "error of h", "loads wrong")
    lines = [_line(head), _line(["---"] * len(head))]
    for points in data["points"].values:
        for method in data["method"].values:
            row = data.sel({"method": method, "points": points})
            if row["seconds"].notnull().any():
                lines.append(_line(_cells(data, row)))
    return "\n".join([*_preface(data), "", *lines, ""])


def _cells(data: xr.Dataset, row: xr.Dataset) -> list[str]:
    at = {"method": row["method"], "points": row["points"]}
    ours = (
        float(median(data).sel({"method": OURS, "points": row["points"]}))
        if OURS in data["method"].values
        else np.nan
    )
    own = float(median(data).sel(at))
    lies, gives_up = int(wrong(data).sel(at)), int(failed(data).sel(at))
    verdict = [f"{lies} said to have converged"] * (lies > 0) + [f"{gives_up} given up"] * (gives_up > 0)
    return [
        f"{int(row['points'])}",
        str(row["label"].values),
        f"{own:.3g}",
        f"{own / ours:.3g}",
        f"{float(row['work'].mean()):.3g} {row['work_unit'].values}",
        f"{float(row['residual'].max()):.1e}",
        f"{float(row['error']):.1e}",
        ", ".join(verdict) or "0",
    ]


def _line(cells: list[str] | tuple[str, ...]) -> str:
    return f"| {' | '.join(cells)} |"


def _preface(data: xr.Dataset) -> list[str]:
    about = data.attrs
    loads = data["mean_pressure"].values
    repeats = data.sizes["repeat"]
    return [
        f"# Side by side: {loads.size} loads in [{loads[0]:.3g}, {loads[-1]:.3g}] p_0*",
        "",
        f"D = {about['D']:g}, gamma = {about['gamma']}, m = {about['m']}. {about['machine']}; one thread; "
        f"{about['packages']}. Medians of {repeats} runs, taken in turn; seconds for the whole curve, from the "
        "heaviest load down, each load from the one before.",
        "",
        f"Everyone is asked for a residual of {about['tolerance']:.0e} g_0: the largest |gap| under pressure or "
        f"penetration elsewhere, from the pressure it returns and a freshly applied operator. {about['comment']} "
        "Their own tolerances are, load by load, the loosest that leave this residual.",
        "",
        f"Errors of h, in g_0, against method {about['truth_method']}, which took {about['truth_seconds']:.3g} s "
        "for the same curve. Work counts pairs of FFTs, those of coarser grids by their size, or dense solutions.",
    ]


def write_table(data: xr.Dataset, path: Path) -> None:
    """Write the Markdown whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as beside:
        beside.write_text(table(data), encoding="utf-8")


def draw(data: xr.Dataset, path: Path) -> None:
    """Draw time and work against N, and error against time, as PDF, SVG and PNG beside each other."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with matplotlib.style.context(style.RC, after_reset=True):
        figure, (time, accuracy) = style.column(2)
        _draw_cost(time, data)
        _draw_accuracy(accuracy, data)
        for suffix, metadata in METADATA.items():
            with replacing(path.with_suffix(f".{suffix}")) as beside:
                figure.savefig(beside, format=suffix, metadata=metadata)


def _draw_cost(axes: Axes, data: xr.Dataset) -> None:
    """Seconds as lines on the left, FFT pairs a load as open marks on the right."""
    style.name_panel(axes, 0, 2, "time (lines) and FFT pairs a load (open marks)")
    axes.set(xscale="log", yscale="log", xlabel="nodes $N$", ylabel="time for a curve (s)")
    axes.set_xscale("log", base=2)
    pairs = axes.twinx()
    pairs.set(yscale="log", ylabel="FFT pairs a load")
    axes.tick_params(right=False, which="both")
    for method in data["method"].values:
        row = data.sel({"method": method})
        look = {**LOOKS[str(method)]._asdict(), "label": str(row["label"].values)}
        axes.plot(row["points"], median(row), marker=MARKERS[str(method)], **look)
        if str(row["work_unit"].values) == "FFT pairs":
            pairs.plot(
                row["points"], row["work"].mean("mean_pressure"), linestyle="none", marker=MARKERS[str(method)],
                color=look["color"], markerfacecolor="white", markeredgewidth=0.7,
            )  # fmt: skip
    axes.legend(loc="upper left", fontsize=6.5)
    axes.margins(y=0.35)


def _draw_accuracy(axes: Axes, data: xr.Dataset) -> None:
    """The error bought with time: each mark a size."""
    style.name_panel(axes, 1, 2, "accuracy bought with time")
    axes.set(xscale="log", yscale="log", xlabel="time for a curve (s)", ylabel="largest error of $h/g_0$")
    for method in data["method"].values:
        row = data.sel({"method": method})
        look = LOOKS[str(method)]._replace(label=str(row["label"].values))._asdict()
        axes.plot(median(row), row["error"], marker=MARKERS[str(method)], **look)
    if data.attrs["truth_method"] == "patches":
        axes.axvline(data.attrs["truth_seconds"], color="0.5", linewidth=0.8)
        axes.annotate(
            "contact patches\n(ten digits)", (data.attrs["truth_seconds"], 0.98), rotation=90, fontsize=6.5,
            xycoords=("data", "axes fraction"), ha="right", va="top", color="0.35",
        )  # fmt: skip
