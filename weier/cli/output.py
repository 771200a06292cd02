"""The file of `weier solve`, from which an interrupted solution, or one of fewer loads, goes on."""

from __future__ import annotations

import warnings
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

import click
import numpy as np
import xarray as xr

from weier.api.task import Known
from weier.cli import result
from weier.data import dataset
from weier.data.files import check_target
from weier.methods.load_progress import curve_so_far
from weier.pipeline import resume
from weier.pipeline.jobs import APPEND_SECONDS
from weier.scene.case import Case
from weier.units import unit_of

if TYPE_CHECKING:
    from weier.cli.one_profile import Request


class Output:
    """The output file of `weier solve`, and a partial file with the loads solved so far.

    The partial file, such as curve.part.nc for curve.csv, is written every `APPEND_SECONDS`, and removed at the end.

    goes_on : whether a further run goes on from it
    owned : whether it has been read, or written by this run
    """

    def __init__(self, path: Path, request: Request, case: Case) -> None:
        self.path, self.part, self.request = path, path.with_name(f"{path.stem}.part.nc"), request
        bodies = request.bodies and request.bodies.at(case.profile)
        self.goes_on, self.owned = bool(resume.continued(case, bodies)), False
        self.saved = monotonic()
        check_target(self.part)

    def known(self, case: Case) -> dict[str, Known]:
        """Return the curves of the files, whose loads replace those of the request that differ by rounding."""
        bodies, known = self.request.bodies, dict[str, Known]()
        for path in filter(Path.exists, (self.path, self.part)):
            loads, known = resume.read(path, case, bodies and bodies.at(case.profile))
            same = np.isclose(self.request.loads[:, None], loads, 1e-15, 0.0)
            if (others := ~same.any(axis=0)).any():
                pressure = dataset.read(path)["mean_pressure"]
                raise ValueError(
                    f"{path} exists, with {others.sum()} loads that are not asked for, such as "
                    f"{pressure.values[others][0]:.6g} {unit_of(pressure)}: add them, or {resume.OTHERWISE}"
                )
            own = np.where(same.any(axis=1), loads[same.argmax(axis=1)], self.request.loads)
            self.request = self.request._replace(loads=own)
            self.owned |= path == self.part
            if self.goes_on:
                click.echo(f"{path} has {loads.size} of {np.unique(own).size} loads", err=True)
        return known

    def __call__(self) -> None:
        """Write the loads solved so far, every few seconds."""
        if monotonic() - self.saved > APPEND_SECONDS and (data := curve_so_far()) is not None:
            self.save(data)

    def save(self, data: xr.Dataset) -> None:
        """Write the solved loads to the partial file."""
        with warnings.catch_warnings(action="ignore"):  # the whole curve warns of yield
            result.write(self.request.with_units(data), self.part)
        self.saved, self.owned = monotonic(), True

    def finish(self, data: xr.Dataset, in_order: xr.Dataset) -> None:
        """Write the output file; text formats keep the given order of loads."""
        result.write(in_order if self.path.suffix in result.TEXTS else self.request.with_units(data), self.path)
        if self.owned:
            self.part.unlink(missing_ok=True)
