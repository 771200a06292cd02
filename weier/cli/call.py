"""The one place that turns options of a command into the arguments of `weier.solve` or `weier.Interface.solve`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
import xarray as xr

from weier import units
from weier.api.interface import Interface
from weier.api.solve import solve_under
from weier.api.task import Known
from weier.data.si import with_pressures_in
from weier.data.variables import LOADS, Status
from weier.kernels.arrays import Array
from weier.methods.load_progress import INTERRUPTIONS
from weier.methods.registry import default_method, find_method
from weier.methods.settings import TOLERANCE
from weier.scene import BY_DEFAULT, Figure, Grouping
from weier.scene.case import read_trace
from weier.scene.trace_keys import TRACE_KEYS
from weier.scene.yaml import read_yaml
from weier.surface.loads import listed_loads
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile
from weier.surface.waves import Waves

INTERFACE = "interface"  # key of a scene that holds the bodies
SERIES = ("D", "gamma", "m", "phases", "seed")  # the options of a series, of which the first three are required


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
        pressures: str | None,
        loads: str | None = None,
        default_loads: str = "",
        methods: Sequence[str] = (),
        tolerance: float | None = None,
        settings: Iterable[tuple[str, str, Any]] = (),
    ) -> Call:
        """Return the call for the options of a command."""
        if pressures is not None and loads is not None:
            raise click.UsageError("loads are given once, got --pressures and --loads")
        if pressures is not None and bodies is None:
            raise click.UsageError("--pressures are in Pa: name the two bodies by --si, or take --loads, in p_0*")
        both, unit = None if bodies is None else read_bodies(bodies), ""
        if pressures is None:
            text = default_loads if loads is None else loads
            values, _ = listed_loads(units.listed("loads", text, units.NORMALISED_PRESSURE)[0], "loads")
            values = values if both is None else both.at(surfaces[0]).pressure(values)
        else:
            given, unit = units.listed("pressures", pressures, units.PASCAL)
            values, _ = listed_loads(given, "pressures", units.PASCAL)
            if not unit:
                click.echo(f"--pressures {pressures}: taken in Pa, since no unit is given", err=True)
        methods = methods or [default_method(*surfaces, within_tolerance=tolerance is not None)]
        by_method: dict[str, Any] = {} if tolerance is None else {TOLERANCE: tolerance}
        for method, name, value in settings:
            by_method.setdefault(method, {})[name] = value
        return cls(surfaces, values, list(methods), by_method, both, unit)

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

    def check_figure(self) -> None:
        """Refuse a figure of a single load, before it is solved."""
        if self.loads.size < 2:
            raise click.UsageError("a figure takes at least 2 loads, got 1: give a range, such as 1e-3:4:40")

    def draw(self, curves: xr.Dataset, path: Path, quantity: str, grouping: Grouping = BY_DEFAULT) -> None:
        """Draw a quantity of curves in normalised units."""
        from weier.figures import draw  # matplotlib takes half a second, and only some commands need it

        figure = Figure(quantity, grouping=grouping, interface=self.bodies)
        draw(figure, [with_pressures_in(curves, self.unit)], path, [path.suffix[1:]])


def solved_loads(curves: xr.Dataset) -> xr.Dataset:
    """Return curves at the loads that at least one method has solved."""
    return curves.isel({LOADS: np.isfinite(curves["compliance"].values).any(axis=(0, 1))})


def check_solved(curves: xr.Dataset) -> None:
    """Raise ValueError if a requested curve is missing, of which a warning has told the reason."""
    if (curves["status"] != Status.solved).any():
        raise ValueError("not all curves could be solved, for the reasons above; all other numbers were written")


def read_bodies(path: Path) -> Interface:
    """Return the bodies of a YAML file, or of the key `interface` of a scene; values may have units."""
    given = read_yaml(path.read_text(encoding="utf-8")).values
    given = given if isinstance(given, dict) else {}
    try:
        return Interface.from_texts(given.get(INTERFACE, given))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def profile_call(default_loads: str, plotted: Sequence[str] = (), **given: Any) -> Call:
    """Return the call for the options of one profile, by the methods `plotted` that apply if none is given."""
    trace_file, of_surface = given.pop("trace_file"), {name: given.pop(name, None) for name in (*SERIES, *TRACE_KEYS)}
    surface = _surface(trace_file, {name: value for name, value in of_surface.items() if value is not None})
    given["methods"] = given["methods"] or [name for name in plotted if find_method(name).takes(surface)]
    return Call.of([surface], default_loads=default_loads, **given)


def _surface(trace_file: Path | None, given: Mapping[str, Any]) -> Waves:
    """Return the series or the trace of the options that are given."""
    series = {name: value for name, value in given.items() if name in SERIES}
    if series and (trace_file is not None or len(series) < len(given)):
        raise click.UsageError(f"take a series, or --trace with its options, got both: {', '.join(given)}")
    if trace_file is not None:
        return trace_of(trace_file, given)
    if not {*SERIES[:3]} <= series.keys():
        raise click.UsageError("a profile takes -D, --gamma and -m, or --trace with a file")
    if len(series.get("phases", ())) == 1:
        (series["phases"],) = series["phases"]
    return Profile(**series)


def trace_of(file: Path, options: Mapping[str, Any]) -> Trace:
    """Return the trace of a file by the options of a command, or its gap to the trace of another body."""
    return read_trace({"file": str(file)} | {name: value for name, value in options.items() if value is not None})
