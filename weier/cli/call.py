"""The one place that turns options of a command into the arguments of `weier.solve` or `weier.Interface.solve`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click
import xarray as xr

from weier import units
from weier.api.interface import Interface
from weier.api.solve import solve_under
from weier.data.si import with_pressures_in
from weier.data.variables import Status
from weier.methods.load_progress import INTERRUPTIONS
from weier.methods.registry import default_method
from weier.methods.settings import TOLERANCE
from weier.scene import BY_DEFAULT, Figure, Grouping
from weier.scene.case import read_trace
from weier.scene.trace_keys import TRACE_KEYS
from weier.scene.yaml import read_yaml
from weier.surface.loads import listed_loads
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile
from weier.surface.waves import Waves

SERIES = ("D", "gamma", "m", "phases", "seed")  # the options of a series, of which the first three are required


class Solved(NamedTuple):
    """Curves in normalised units, under loads in p_0* or, with bodies, in Pa.

    unit : the unit in which pressures were given; empty if there was none
    stopped : the exception that ended the solution, such as Ctrl-C; values that are not solved are then NaN
    """

    curves: xr.Dataset
    bodies: Interface | None
    unit: str
    stopped: BaseException | None

    def in_units(self, curves: xr.Dataset) -> xr.Dataset:
        """Return some of the curves in SI units if there are bodies, with pressures in the unit given."""
        return curves if self.bodies is None else with_pressures_in(self.bodies.in_si(curves), self.unit)

    def draw(self, curves: xr.Dataset, path: Path, quantity: str, grouping: Grouping = BY_DEFAULT) -> None:
        """Draw a quantity of some of the curves."""
        from weier.figures import draw  # matplotlib takes half a second, and only some commands need it

        figure = Figure(quantity, grouping=grouping, interface=self.bodies)
        draw(figure, [with_pressures_in(curves, self.unit)], path, [path.suffix[1:]])

    def check_whole(self) -> None:
        """Raise the exception that ended the solution, or ValueError if a curve is missing, with a warning above."""
        if self.stopped is not None:
            raise self.stopped
        if (self.curves["status"] != Status.solved).any():
            raise ValueError("not all curves could be solved, for the reasons above; all other numbers were written")


def solve(
    surfaces: Sequence[Waves],
    *,
    bodies: Path | None,
    pressures: str | None,
    workers: int,
    loads: str | None = None,
    default_loads: str = "",
    methods: Sequence[str] = (),
    tolerance: float | None = None,
    settings: Iterable[tuple[str, str, Any]] = (),
    drawn: bool = False,
) -> Solved:
    """Solve surfaces by the options of a command; `drawn` curves take several loads."""
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
    if drawn and values.size < 2:
        raise click.UsageError("a figure takes at least 2 loads, got 1: give a range, such as 1e-3:4:40")
    methods = methods or [default_method(*surfaces, within_tolerance=tolerance is not None)]
    options: dict[str, Any] = {} if tolerance is None else {TOLERANCE: tolerance}
    for method, name, value in settings:
        options.setdefault(method, {})[name] = value
    stopped: BaseException | None = None
    try:
        curves = solve_under(list(surfaces), values, both, list(methods), workers=workers, **options)
    except INTERRUPTIONS as stop:
        if getattr(stop, "curve", None) is None:
            raise
        curves, stopped = vars(stop)["curve"], stop
    if (curves["status"] != Status.solved).all():
        raise ValueError("no curve could be solved, for the reasons above")
    return Solved(curves, both, unit, stopped)


def read_bodies(path: Path) -> Interface:
    """Return the bodies of a YAML file, or of the key `interface` of a scene; values may have units."""
    try:
        given = read_yaml(path.read_text(encoding="utf-8")).values
        given = given if isinstance(given, dict) else {}
        return Interface.from_texts(given.get("interface", given))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def take_profile(options: dict[str, Any]) -> Waves:
    """Take the series or the trace out of the options of a command."""
    file, series, of_trace = options.pop("trace_file"), _take(SERIES, options), _take(TRACE_KEYS, options)
    if series and (file is not None or of_trace):
        given = ", ".join(series | of_trace)
        raise click.UsageError(f"take a series, or --trace with its options, got both: {given}")
    if file is not None:
        return read_trace({"file": str(file), **of_trace})
    if not {*SERIES[:3]} <= series.keys():
        raise click.UsageError("a profile takes -D, --gamma and -m, or --trace with a file")
    if len(series.get("phases", ())) == 1:
        (series["phases"],) = series["phases"]
    return Profile(**series)


def take_lines(files: Iterable[Path], options: dict[str, Any]) -> list[Trace]:
    """Take the distinct lines of some files out of the options of a command."""
    of_trace = _take(TRACE_KEYS, options)
    lines = dict[str, Trace]()
    for line in (read_trace({"file": str(file), **of_trace}) for file in files):
        if line.digest in lines:
            click.echo(f"{line.source} is left out: it has the heights of {lines[line.digest].source}", err=True)
        lines.setdefault(line.digest, line)
    return [*lines.values()]


def _take(names: Iterable[str], options: dict[str, Any]) -> dict[str, Any]:
    """Take the options of these names that are given."""
    return {name: value for name in names if (value := options.pop(name, None)) is not None}
