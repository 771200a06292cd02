"""Rows of files: curves and surfaces as plain values by variable name."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from weier.api.task import CurveTask, Outcome
from weier.data.variables import Status
from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.errors import ConvergenceError
from weier.methods.registry import find_method
from weier.surface.waves import Waves, resolvable
from weier.theory.bounds import first_contact, infinite_series_bounds

RMS = "rms_height", "rms_slope", "rms_curvature"
BOUNDS = tuple(f"{quantity}_{side}" for quantity in ("compliance", "resistance") for side in ("lower", "upper"))


def curve_row(curve: CurveTask, outcome: Outcome) -> dict[str, Any]:
    """Return a curve with its status, seconds and bounds on the infinite series; for an error, the status."""
    if isinstance(outcome, Exception):
        unconverged = isinstance(outcome, ConvergenceError)
        return {"status": Status.not_converged if unconverged else Status.not_applicable}
    solution, seconds = outcome
    more = derived(curve.profile, curve.loads, solution) | _bounds(curve, solution)
    return {"status": Status.solved, "seconds": seconds, **solution.values(), **more}


def _bounds(curve: CurveTask, solution: Curve) -> dict[str, Array]:
    """Return bounds on the infinite series, from the curve of a truncated one by a method that solves it."""
    surface: Any = curve.profile
    if not find_method(curve.method).numerical or math.isinf(surface.m) or math.isnan(surface.tail_amplitude):
        return {}
    return infinite_series_bounds(surface, curve.loads, solution.compliance, solution.values()["compliance_error"])


def derived(surface: Waves, loads: Array, solution: Curve) -> dict[str, Array]:
    """Return the mean gap and, with a contact fraction A, kappa = A E* h'/p, where p_0* = pi E* g_0/lambda_0."""
    gap = {"mean_gap": surface.total_amplitude - solution.compliance}
    if solution.contact_fraction is None:
        return gap
    slope = surface.rms[1] if math.isfinite(surface.rms[1]) else math.nan
    return gap | {"area_coefficient": solution.contact_fraction * slope / (np.pi * loads)}


def surface_row(surface: Waves) -> dict[str, Any]:
    """Return the description of a surface: labels, phases, and heights that no method changes."""
    row = surface.labels | {
        "phases": surface.listed_phases,
        "total_amplitude": surface.total_amplitude,
        "tail_amplitude": surface.tail_amplitude,
        **dict(zip(RMS, surface.rms, strict=True)),
    }
    if math.isfinite(surface.m) and resolvable(surface):
        row["first_contact"] = first_contact(surface)
    return row
