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

from weier.accuracy import runs
from weier.accuracy.metrics import by_resolved_terms
from weier.accuracy.page import Page, measurement, number
from weier.accuracy.runner import run
from weier.accuracy.runs import Comparison
from weier.accuracy.variants import Variant
from weier.data import variables
from weier.data.markdown import table
from weier.data.selection import case_names
from weier.data.variables import LABEL, Status, Variable
from weier.methods import bem
from weier.methods.errors import ConvergenceError, OutOfReachError
from weier.scene import Case, load
from weier.surface.loads import checked_loads
from weier.surface.profile import Profile
from weier.theory.bounds import complete_bounds

SCENE = Path("config/accuracy/infinite.yaml")
MESH_FRACTION = 0.1  # ratio of mesh error to tail amplitude; the mesh widens the bounds by at most a tenth
MAX_TOLERANCE = 0.9  # g_0, the largest that boundary elements take; the tail of a gamma near 1 is much higher
HEADER = ("series", "resolved terms", "nodes", "half-width of the bounds", "error of the estimate")
H = "compliance", "compliance_lower", "compliance_upper"
KEPT = ("total_amplitude", "tail_amplitude", *H, "resistance", "residual", "points", "status")
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
    variants = tuple(Variant(str(terms), bem.METHOD.name, {}) for terms in range(1, max_terms + 1))
    compared = [
        Comparison(profile.describe(), Case.from_surface(profile, (), {}), loads, variants) for profile in profiles
    ]
    data = runs.blank(compared, KEPT, {})
    runs.fill(data, compared, _solve)
    counts = np.array(data["variant"].values, int)
    data = data.drop_vars(["solution_method", "variant"]).rename_dims(variant="resolved_terms")
    return data.assign_coords(resolved_terms=("resolved_terms", counts, variables.attributes("resolved_terms", OWN)))


def _solve(compared: Comparison, variant: Variant) -> Mapping[str, Any]:
    """Return the bounds from the first terms by boundary elements, and their middle as the estimate."""
    profile, terms = compared.case.profile, int(variant.name)
    kept = profile.truncated(terms)
    tolerance = min(MESH_FRACTION * kept.tail_amplitude, MAX_TOLERANCE)
    try:
        solved = run(variant._replace(settings={"tolerance": tolerance}), kept, compared.loads)
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
