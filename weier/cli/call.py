"""Options of a command as a call of `weier.solve` or `weier.Interface.solve`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
import xarray as xr

from weier.api.interface import Interface
from weier.api.solve import solve_under
from weier.api.task import Known
from weier.cli.options import NEEDED, SERIES, Pressures
from weier.data.si import with_pressures_in
from weier.data.variables import LOADS, Status
from weier.kernels.arrays import Array
from weier.methods.load_progress import INTERRUPTIONS
from weier.methods.registry import default_method
from weier.methods.settings import TOLERANCE
from weier.scene import BY_DEFAULT, Figure, Grouping
from weier.scene.case import read_traces
from weier.scene.yaml import parse_yaml
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile
from weier.surface.waves import Waves

INTERFACE = "interface"  # key of a scene that holds the bodies
# Reason in words for each status of a missing curve.
WHY = {
    Status.not_applicable: "does not apply",
    Status.not_converged: "missed its tolerance",
}


class Call(NamedTuple):
    """Surfaces, their loads and the methods.

    loads : increasing and distinct, in p_0*, or in Pa if there are bodies
    unit : the unit in which pressures were given; empty if there was none
    """

    surfaces: Sequence[Waves]
    loads: Array
    methods: Sequence[str]
    settings: Mapping[str, Any]
    bodies: Interface | None
    unit: str

    @classmethod
    def of(
        cls,
        surfaces: Sequence[Waves],
        bodies: Path | None,
        given: Array | Pressures,
        methods: Sequence[str] = (),
        tolerance: float | None = None,
        settings: Iterable[tuple[str, str, Any]] = (),
    ) -> Call:
        """Return the call for the options of a command; `given` are loads, or pressures and their unit."""
        both = None if bodies is None else read_bodies(bodies)
        loads, unit = given if isinstance(given, tuple) else (given, "")
        if both is not None and not isinstance(given, tuple):
            loads = both.at(surfaces[0]).pressure(loads)
        methods = methods or [default_method(*surfaces, within_tolerance=tolerance is not None)]
        by_method: dict[str, Any] = {} if tolerance is None else {TOLERANCE: tolerance}
        for method, name, value in settings:
            by_method.setdefault(method, {})[name] = value
        return cls(surfaces, np.unique(loads), list(methods), by_method, both, unit)

    def own_loads(self, surface: Waves) -> Array:
        """Return these loads in p_0* for a surface."""
        return self.loads if self.bodies is None else self.bodies.at(surface).normalised_pressure(self.loads)

    def solve(
        self, workers: int, known: Mapping[str, Known] | None = None
    ) -> tuple[xr.Dataset, BaseException | None]:
        """Return curves in normalised units, and the exception that stopped them, or None.

        Ctrl-C stops it; values that are not solved are then NaN.
        """
        options: dict[str, Any] = {"workers": workers, "known": known, **self.settings}
        loads_of = None if self.bodies is None else self.own_loads
        stopped: BaseException | None = None
        try:
            curves = solve_under(list(self.surfaces), self.loads, loads_of, self.methods, **options)
        except INTERRUPTIONS as stop:
            if getattr(stop, "curve", None) is None:
                raise
            curves, stopped = vars(stop)["curve"], stop
        if (curves["status"] != Status.solved).all():
            raise ValueError("no curve could be solved, for the reasons above")
        return curves, stopped

    def in_units(self, curves: xr.Dataset) -> xr.Dataset:
        """Return curves in SI units if there are bodies, with pressures in the unit given."""
        return curves if self.bodies is None else with_pressures_in(self.bodies.in_si(curves), self.unit)

    def draw(self, curves: xr.Dataset, path: Path, quantity: str, grouping: Grouping = BY_DEFAULT) -> None:
        """Draw a quantity of curves in normalised units."""
        from weier.figures import draw  # matplotlib takes half a second, and only some commands need it

        figure = Figure(quantity, grouping=grouping, interface=self.bodies)
        draw(figure, [with_pressures_in(curves, self.unit)], path, [path.suffix[1:]])


def solved_loads(curves: xr.Dataset) -> xr.Dataset:
    """Return curves at the loads that at least one method has solved."""
    return curves.isel({LOADS: np.isfinite(curves["compliance"].values).any(axis=(0, 1))})


def check_solved(curves: xr.Dataset) -> None:
    """Raise ValueError if a requested curve is missing."""
    methods = curves["solution_method"].values.tolist()
    numbers = [pair for case in curves["status"].values.tolist() for pair in zip(methods, case, strict=True)]
    missing = [f"{method} {WHY[Status(number)]}" for method, number in numbers if number != Status.solved]
    if missing:
        raise ValueError(
            f"{', '.join(dict.fromkeys(missing))}, for the reasons above; all other numbers were written"
        )


def read_bodies(path: Path) -> Interface:
    """Return the bodies of a YAML file, or of the key `interface` of a scene; values may have units."""
    given = parse_yaml(path.read_text(encoding="utf-8"))
    given = given if isinstance(given, dict) else {}
    try:
        return Interface.from_texts(given.get(INTERFACE, given))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def surface_of(trace_file: Path | None, options: Mapping[str, Any]) -> Waves:
    """Return the series or the trace of the options of a command."""
    given = {name: value for name, value in options.items() if value is not None}
    series = {name: given.pop(name) for name in SERIES if name in given}
    if trace_file is not None:
        if series:
            raise click.UsageError(f"a trace has no {', '.join(series)}: take --trace or a series")
        if len(lines := traces_of(trace_file, given)) > 1:
            raise click.UsageError(f"{trace_file} has {len(lines)} lines: name one by --line")
        return lines[0]
    if given:
        raise click.UsageError(
            f"--{next(iter(given)).replace('_', '-')} is an option of traces: name a file by --trace"
        )
    if missing := [option for option, name in NEEDED.items() if name not in series]:
        raise click.UsageError(f"a profile takes -D, --gamma and -m, or --trace; missing: {', '.join(missing)}")
    return Profile(**series)


def traces_of(file: Path, options: Mapping[str, Any]) -> list[Trace]:
    """Return the lines of a file by the options of a command, or the gaps to the line of another body."""
    return read_traces({"file": str(file)} | {name: value for name, value in options.items() if value is not None})
