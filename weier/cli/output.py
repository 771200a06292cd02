"""The file of `weier solve`, from which a solution that was interrupted, or had fewer loads, is resumed."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from time import monotonic
from typing import Any

import click
import numpy as np
import xarray as xr

from weier import units
from weier.api.task import Known
from weier.cli.call import Call, solved_loads
from weier.data import dataset
from weier.data.variables import LOADS, VARIABLES
from weier.digests import numerics
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES, Curve
from weier.methods.load_progress import curve_so_far
from weier.methods.registry import find_method

SAVE_SECONDS = 10.0  # interval between saves: a kill loses this much work
PROBLEM = "problem"  # attribute of a file, which identifies what is solved
OTHERWISE = "name another file, or solve anew by --force"


class SolutionFile:
    """The output file of `weier solve`, and a partial file with the loads solved so far.

    The partial file, such as curve.part.nc for curve.nc, is written every `SAVE_SECONDS`, and removed at the end.
    Both state the problem: the surface, the methods with their settings, the bodies and the code.
    """

    def __init__(self, path: Path, call: Call) -> None:
        self.path, self.part, self.call, self.saved = path, path.with_name(f"{path.stem}.part.nc"), call, monotonic()
        (self.surface,) = call.surfaces
        self.bodies = call.bodies and call.bodies.at(self.surface)
        parts = {
            "surface": getattr(
                self.surface, "digest", self.surface.parameters
            ),  # a trace, whatever its file is called
            "methods": sorted(call.methods),
            "settings": call.settings,
            "bodies": self.bodies and self.bodies.given,
            "code": numerics(),
        }
        self.problem = {name: json.dumps(part, sort_keys=True) for name, part in parts.items()}

    def known(self) -> dict[str, Known]:
        """Return the solved curves of the files; ValueError for another problem or further loads."""
        found, loads = dict[str, Known](), self.call.loads
        unit = units.NORMALISED_PRESSURE if self.bodies is None else units.PASCAL
        for path in filter(Path.exists, (self.path, self.part)):
            data = self._read(path)
            pressures = units.in_unit(LOADS, data[LOADS], unit)
            at = np.abs(loads[:, None] - pressures).argmin(axis=0)
            if others := pressures[~np.isclose(loads[at], pressures, 1e-12, 0.0)].tolist():
                raise ValueError(
                    f"{path} exists, with {len(others)} loads that are not asked for, such as {others[0]:.6g} "
                    f"{unit}: add them, or {OTHERWISE}"
                )
            click.echo(f"{path} has {pressures.size} of {loads.size} loads", err=True)
            found |= self._curves(data.isel(case=0), self.call.own_loads(self.surface)[at])
        return found

    def _read(self, path: Path) -> xr.Dataset:
        """Return the content of a file of this problem."""
        try:
            data = dataset.read(path)
            theirs = json.loads(data.attrs[PROBLEM])
        except (ValueError, KeyError):
            raise ValueError(f"{path} exists, and is not of `weier solve`: {OTHERWISE}") from None
        for name, ours in self.problem.items():
            if theirs.get(name) != ours:
                raise ValueError(f"{path} exists, of other {name}: {theirs.get(name)}, not {ours}: {OTHERWISE}")
        return data

    def _curves(self, data: xr.Dataset, loads: Array) -> dict[str, Known]:
        """Return the solved curves of a file under these loads, in normalised units.

        Curves in SI units between perfect conductors are left out, since R = 0 cannot be converted back.
        """
        scales = {} if self.bodies is None else {name: float(one) for name, (one, _) in self.bodies.scales().items()}
        found = dict[str, Known]()
        for method in data["solution_method"].values.tolist() if all(scales.values()) else ():
            run, values = data.sel(solution_method=method), dict[str, Any]()
            solved = np.isfinite(run["compliance"].values)
            for name in {*QUANTITIES, *find_method(method).returns} & {*map(str, run.data_vars)}:
                value = run[name].values
                if LOADS in run[name].dims:
                    values[name] = value[solved] / scales.get(VARIABLES[name].unit, 1.0)
                elif value.dtype.kind in "UO" or np.isfinite(value):
                    values[name] = value.item()
            if solved.any():
                found[method] = Known(loads[solved], Curve(**values), float(run.get("seconds", np.nan)))
        return found

    def __call__(self) -> None:
        """Write the loads solved so far, every few seconds."""
        if monotonic() - self.saved > SAVE_SECONDS and (curves := curve_so_far()) is not None:
            with warnings.catch_warnings(action="ignore"):  # the whole curve warns of yield
                self.save(solved_loads(curves))

    def save(self, curves: xr.Dataset, whole: bool = False) -> None:
        """Write the solved loads to the partial file, or all to the output file, which replaces it."""
        data = self.call.in_units(curves).drop_vars("case").assign_attrs({PROBLEM: json.dumps(self.problem)})
        dataset.write(data, self.path if whole else self.part, str(self.surface.describe()))
        self.saved = monotonic()
        if whole:
            self.part.unlink(missing_ok=True)
