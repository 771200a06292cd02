"""Speed against accuracy: all variants of methods on the profiles of a scene, against the exact contact."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import click
import numpy as np
import xarray as xr

from weier.accuracy import runs
from weier.accuracy.metrics import MEASURED, STATED, by_load, deviation, seconds_per_load
from weier.accuracy.page import Page, measurement, number
from weier.accuracy.reference import contact_reference
from weier.accuracy.runner import run
from weier.accuracy.runs import Comparison
from weier.accuracy.variants import Variant, variants_of
from weier.data.markdown import plain, table
from weier.data.variables import LOAD_DIMS, VARIABLES, Status, Variable
from weier.kernels.arrays import Array
from weier.methods import registry
from weier.methods.curve import QUANTITIES
from weier.methods.errors import ConvergenceError
from weier.scene import Scene, load
from weier.surface.limits import check_resolvable
from weier.surface.profile import Profile

SCENE = Path("config/accuracy/tradeoff.yaml")
# runs per median: other processes lengthen some runs, and the clock of a virtual machine may shorten others
REPEAT = 5
# results copied from the table of variables
KEPT = (
    *runs.KEPT,
    "resistance_error",
    "resistance_deviation",
    "contact_fraction",
    "patch_count",
    "residual",
    "work",
    "status",
    "seconds",
)
OWN = {
    **{name: VARIABLES[name] for name in ("seconds", "compliance_deviation", "resistance_deviation")},
    "reference_compliance": Variable(LOAD_DIMS, "compliance of the exact contact", "g_0"),
    "reference_resistance": Variable(LOAD_DIMS, "resistance of the exact contact", "g_0/p_0*"),
}


def measure(scene: Scene) -> xr.Dataset:
    """Run all variants on all cases of a scene, one after the other, on one core.

    Parameters
    ----------
    scene : Scene
        Its profiles, of finite series, and its loads; its methods are ignored.

    Returns
    -------
    Dataset
        As the dataset of a scene, over variants instead of methods, with `seconds` of processor time for all loads.
        compliance_deviation and resistance_deviation are the distances from reference_compliance and
        reference_resistance; compliance_error and resistance_error are errors stated by a method, NaN where it states
        none. All are NaN where a variant would need too many points, or did not converge.
    """
    comparisons = [
        Comparison(case.profile.describe(), case, scene.loads, tuple(variants(case.profile)))
        for case in scene.cases.values()
    ]
    data = runs.blank(comparisons, KEPT, OWN)
    for case, compared in enumerate(comparisons):
        print(f"reference {case + 1}/{len(comparisons)}: {compared.name}", file=sys.stderr)
        right = contact_reference(compared.case.profile, tuple(compared.loads.tolist()))
        data["reference_compliance"].values[case] = np.array(right.compliance, float)
        data["reference_resistance"].values[case] = np.array(right.resistance, float)
    runs.fill(data, comparisons, _measure)
    return data


def variants(profile: Profile) -> list[Variant]:
    """Return all variants with compliance and resistance that can be run on a finite series."""
    if math.isinf(profile.m):
        raise ValueError(
            f"m must be finite to trade speed for accuracy, got {profile.describe()}: leave the case out"
        )
    check_resolvable(profile)
    applicable = [method for method in registry.METHODS if method.stiffness and method.takes(profile)]
    return [variant for method in applicable for variant in variants_of(method, profile)]


def _measure(compared: Comparison, variant: Variant) -> dict[str, Any]:
    profile, loads = compared.case.profile, compared.loads
    try:
        result = run(variant, profile, loads, REPEAT)
    except ConvergenceError as error:
        print(f"{profile.describe()}, {variant.name}: {error}", file=sys.stderr)
        return {"status": Status.not_converged}
    right = contact_reference(profile, tuple(loads.tolist()))
    return {
        **result.others,
        "compliance_deviation": deviation(result.compliance, right.compliance),
        "resistance_deviation": deviation(result.resistance, right.resistance),
        "seconds": result.seconds,
        "status": Status.solved,
    }


ERROR_COLUMNS = ("90 %", "largest", "stated: median")
HEADER = [
    *("method and setting", "profiles", "ms a load"),
    *("error of h: median", *ERROR_COLUMNS, "error of R: median", *ERROR_COLUMNS),
]


def table_of(data: xr.Dataset) -> str:
    """Return a row for each variant."""
    seconds = seconds_per_load(data)
    errors = [by_load(data, quantity, kind) for quantity in QUANTITIES for kind in (MEASURED, STATED)]
    run = np.isfinite(seconds)
    rows = [
        _row(name, seconds[run[:, at], at], *(error[run[:, at], at] for error in errors))
        for at, name in enumerate(data["variant"].values.tolist())
        if run[:, at].any()
    ]
    return table(HEADER, rows)


def _row(name: str, seconds: Array, *errors: Array) -> list[str]:
    """Return the results of a variant: seconds per load on each profile, measured and stated errors of h and R."""
    cells = [plain(name), str(seconds.size), number(1e3 * np.median(seconds), ".2g")]
    for measured, stated in (errors[:2], errors[2:]):
        quantiles = np.median(measured), np.quantile(measured, 0.9), measured.max(), np.median(stated)
        cells += map(number, quantiles)
    return cells


@measurement("Speed against accuracy")
@click.option("--scene", type=click.Path(path_type=Path), default=SCENE, help="Its profiles and loads.")
def main(scene: Path) -> Page:
    """Measure the errors and seconds of all methods and settings.

    Each row is one method at one setting, on all profiles that it was run on. `bem 1e-03` and `patches 1e-06` have
    these tolerances of the compliance, in g_0. `bem kept 12` has the paper's 12 points for each of the finest waves
    and keeps the staircase, and `layer 24` has 24 points a wave.

    Errors are distances from the exact contact: closed forms for one wave and for full contact, and otherwise contact
    patches at a tolerance of 1e-12 on the same profile shifted along x. The error of the compliance h is in g_0, that
    of the resistance R is relative to the larger of R and 1 g_0/p_0*. The quantiles are over all loads of all
    profiles, and stated errors are those of the method itself.

    Milliseconds are processor time on one core, the median over the profiles, each the median of five runs. A finer
    grid is run on fewer profiles, so compare rows that have equally many.
    """
    loaded = load(scene)
    data = measure(loaded)
    return Page([table_of(data)], data, loaded.text)
