"""Convergence of the estimate and the bounds of the infinite series with the number of resolved terms."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from weier.accuracy.metrics import by_resolved_terms
from weier.accuracy.report import Page, measurement, number
from weier.accuracy.runner import run
from weier.accuracy.variants import Variant
from weier.data import dataset, variables
from weier.data.markdown import table
from weier.data.selection import case_names
from weier.data.variables import CONVERGENCE, LABEL, Status, Variable, variables_of_file
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.methods.hybrid.solver import MAX_POINTS, POINTS_PER_WAVE, bounds
from weier.scene import load
from weier.surface.loads import checked_loads
from weier.surface.profile import PARAMETERS, Profile

SCENE = Path("config/accuracy/infinite.yaml")
HEADER = ("series", "resolved terms", "nodes", "half-width of the bounds", "error of the estimate")
OWN = {"resolved_terms": Variable(("resolved_terms",), "terms of the series that are resolved", content=LABEL)}


def measure_convergence(profiles: Sequence[Profile], mean_pressure: ArrayLike, max_terms: int) -> xr.Dataset:
    """Return the estimate and its bounds with 1, 2, ... resolved terms.

    Parameters
    ----------
    profiles : sequence of Profile
        With m = inf.
    mean_pressure : array_like, shape (loads,)
        Increasing, in p_0*.
    max_terms : int
        The largest number of resolved terms.

    Returns
    -------
    Dataset
        As that of a scene, over resolved_terms instead of methods. If the grid is too large for the estimate, only
        bounds are given; if it is too large for these as well, see the status.

    Raises
    ------
    ValueError
        If a series is finite, or a load lies outside [1e-6, 1e3].

    """
    loads = checked_loads(mean_pressure)
    data = _blank(len(profiles), loads, max_terms)
    for case, profile in enumerate(profiles):
        values = {name: float(getattr(profile, name)) for name in PARAMETERS}
        for name, value in {**values, "tail_amplitude": 0.0, "total_amplitude": profile.total_amplitude}.items():
            data[name].values[case] = value
        data["phases"].values[case] = profile.truncated(max_terms).phase
        for terms in range(1, max_terms + 1):
            for name, value in _solve(profile, loads, terms).items():
                data[name].values[case, terms - 1] = value
    return data


def _blank(cases: int, loads: Array, max_terms: int) -> xr.Dataset:
    counts = np.arange(1, max_terms + 1)
    data = dataset.blank(cases, [str(count) for count in counts], loads, max_terms)
    data = data.drop_vars(["solution_method", *set(data.data_vars) - set(variables_of_file(CONVERGENCE))])
    data = data.rename_dims(solution_method="resolved_terms")
    return data.assign_coords(resolved_terms=("resolved_terms", counts, variables.attributes("resolved_terms", OWN)))


def _solve(profile: Profile, loads: Array, terms: int) -> Mapping[str, Any]:
    """Return the estimate with its bounds, or the bounds alone if the estimate takes too many points."""
    points = POINTS_PER_WAVE * profile.truncated(terms).waves_per_period[-1]
    try:
        if points <= MAX_POINTS:
            found = run(Variant(f"hybrid {terms}", "hybrid", {"terms": terms}), profile, loads).others
            return {**found, "points": points, "status": Status.solved}
        low, high = bounds(profile, loads, terms)
    except ConvergenceError as error:
        print(f"{profile.describe()}, {terms} terms resolved: {error}", file=sys.stderr)
        return {"status": Status.not_converged}
    except OutOfReachError:
        return {"status": Status.not_applicable}
    return {"compliance_lower": low, "compliance_upper": high, "status": Status.solved}


def table_of(data: xr.Dataset) -> str:
    """Return a row for each number of resolved terms of a series."""
    rows = []
    for row, name in enumerate(case_names(data, but=("phases",))):
        case = data.isel(case=row)
        for terms, nodes, *errors in zip(
            case["resolved_terms"].values, case["points"].values, *by_resolved_terms(case), strict=True
        ):
            rows.append([name, str(terms), number(nodes, ".0f"), *(number(error, ".1e") for error in errors)])
    return table(HEADER, rows)


@measurement("The infinite series, by the terms that are resolved")
@click.option("--scene", type=click.Path(path_type=Path), default=SCENE, help="Its infinite series and loads.")
@click.option("--terms", default=8, help="The largest number of resolved terms.")
def main(scene: Path, terms: int) -> Page:
    """Solve infinite series by the number of terms resolved.

    Heights are in g_0, at the worst load. The bounds hold for any phases of the terms that are not resolved. The
    estimate puts the resolved terms on the layer of all others. Its error is the distance from the middle of finer
    bounds where these have more terms than any estimate, else from the estimate with most terms. Nodes are those of
    the estimate, of which up to 2^14 are solved; bounds are found with up to 2^21.
    """
    loaded = load(scene)
    data = measure_convergence([case.profile for case in loaded.cases.values()], loaded.loads, terms)
    return Page([table_of(data)], data, loaded.text)
