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
from weier.data.variables import LABEL, Status, Variable
from weier.kernels.arrays import Array
from weier.methods import bem
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.scene import load
from weier.surface.loads import checked_loads
from weier.surface.profile import PARAMETERS, Profile
from weier.theory.bounds import complete_bounds

SCENE = Path("config/accuracy/infinite.yaml")
MESH_FRACTION = 0.1  # error of the mesh over the amplitude of the tail: bounds are at most a tenth wider for it
MAX_TOLERANCE = (
    0.9  # g_0, the largest that boundary elements take: the tail of a gamma close to 1 is many times as high
)
HEADER = ("series", "resolved terms", "nodes", "half-width of the bounds", "error of the estimate")
H = "compliance", "compliance_lower", "compliance_upper"
KEPT = ("total_amplitude", "tail_amplitude", *H, "resistance", "residual", "points", "status")  # of the table
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
        As that of a scene, over resolved_terms instead of methods. Where the grid is too large, see the status.

    Raises
    ------
    ValueError
        If a load is out of range.

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
    data = dataset.blank(cases, [str(count) for count in counts], loads, max_terms, returned=KEPT)
    data = data.drop_vars(["solution_method", *set(data.data_vars) - set(KEPT)])
    data = data.rename_dims(solution_method="resolved_terms")
    return data.assign_coords(resolved_terms=("resolved_terms", counts, variables.attributes("resolved_terms", OWN)))


def _solve(profile: Profile, loads: Array, terms: int) -> Mapping[str, Any]:
    """Return the bounds from the first terms by boundary elements, and their middle as the estimate."""
    kept = profile.truncated(terms)
    tolerance = min(MESH_FRACTION * kept.tail_amplitude, MAX_TOLERANCE)
    try:
        solved = run(Variant(f"bem {terms}", bem.METHOD.name, {"tolerance": tolerance}), kept, loads)
    except ConvergenceError as error:
        print(f"{profile.describe()}, {terms} terms resolved: {error}", file=sys.stderr)
        return {"status": Status.not_converged}
    except OutOfReachError:
        return {"status": Status.not_applicable}
    tail, total = kept.tail_amplitude, profile.total_amplitude
    low, high = complete_bounds(solved.compliance, tail, total, solved.compliance_error)
    middle = {"compliance": (low + high) / 2, "resistance": solved.resistance, "points": solved.others["points"]}
    return middle | {"compliance_lower": low, "compliance_upper": high, "status": Status.solved}


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
    estimate is their middle, as of the method "auto", and its error the distance from the estimate with most terms.
    Nodes are those of boundary elements.
    """
    loaded = load(scene)
    data = measure_convergence([case.profile for case in loaded.cases.values()], loaded.loads, terms)
    return Page([table_of(data)], data, loaded.text)
