"""Names of traces in a figure: the file, and the differences between traces of one file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import Any

import xarray as xr

# Properties that may distinguish two traces of one name, in order, with their text in a legend.
DIFFERENCES: dict[str, Callable[[Any], str]] = {
    "trace_shortest": lambda shortest: f"shortest {1e6 * shortest:.4g} \u00b5m",
    "trace_ends": str,
    "trace_detrend": lambda detrend: f"without {detrend}",
    "trace_length": lambda length: f"length {1e3 * length:.4g} mm",
    "trace_filled": lambda filled: f"{filled:.0f} interpolated",
    "trace_digest": str,
}


def names_of_traces(cases: Iterable[xr.Dataset]) -> list[str]:
    """Return a unique name for the trace of each case, empty for a series.

    It is the path of the file in the folder that all have in common, and the differences between traces of this path:
    the shortest wavelength, the ends, and so on, or their digests if nothing else differs.
    """
    traces = [
        {name: case[name].item() for name in ("trace", *DIFFERENCES) if name in case.coords} or {"trace_digest": ""}
        for case in cases
    ]
    known = list({trace["trace_digest"]: trace for trace in traces if trace["trace_digest"]}.values())
    folder = os.path.commonprefix([trace["trace"] for trace in known]).rfind("/") + 1  # noqa: RUF071 - of names, not of folders
    names = {}
    for trace in known:
        alike = [other for other in known if other["trace"] == trace["trace"]]
        names[trace["trace_digest"]] = ", ".join([trace["trace"][folder:] or "trace", *_differences(trace, alike)])
    shown = (names.get(trace["trace_digest"], "").replace("$", r"\$") for trace in traces)
    return [f" {name}" if name.startswith("_") else name for name in shown]  # matplotlib hides "_..."


def _differences(trace: dict[str, Any], alike: list[dict[str, Any]]) -> list[str]:
    """Return the shortest list of texts, in order, that distinguishes a trace from others of the same name."""
    found: list[str] = []
    for name, text in DIFFERENCES.items():
        if len(alike) > 1 and name in trace and len({other[name] for other in alike}) > 1:
            found.append(text(trace[name]))
            alike = [other for other in alike if other[name] == trace[name]]
    return found
