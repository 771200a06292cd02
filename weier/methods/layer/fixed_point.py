"""The infinite series: fixed point of one scale, by Newton's method on all rows of its table.

docs/layer.md, "The whole series", derives the formulas. With J = d ln TW/d ln W from the sensitivities of each wave
(`weier.methods.layer.wave.closure_sensitivity`) and linear interpolation, Newton steps solve ln W - ln TW = 0, and
(I - J)^-1 bounds the relative errors of the table by its deviation from T of itself, measured in the middle of every
cell.
"""

from __future__ import annotations

import math

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array
from weier.methods import archard
from weier.methods.errors import ConvergenceError
from weier.methods.layer.scales import MAX_SCALES, ComplianceTable, Model, Scale, coarser_units
from weier.methods.layer.scaling_tables import (
    Rows,
    accuracy_error,
    evaluate_midpoints,
    lattice,
    log_load_at,
    merge,
    position_in,
)
from weier.methods.layer.wave import MAX_STEP, MAX_STEPS, closure_sensitivity, midpoints

MAX_ROWS = 3000  # its matrices take 70 MB each; the smallest accuracy needs 1200 rows, the default one 110
MAX_MESH_ERROR = 1e-2  # relative; resolved waves have 1e-6 on 24 points and 1e-3 on 4, others 0.1 and more


def infinite_waves(model: Model, bottom: float) -> ComplianceTable:
    """Return the waves of the infinite series of a D and gamma, on a table from this position on."""
    gain = np.array([model.infinite_amplitude])  # number of scales over which errors of ln W add up at heavy loads
    limit, first = _limit(model, gain), lattice(bottom, math.asinh(_top(model)))
    rows, errors = _guess(model, first), gain
    while rows.position.size <= MAX_ROWS:
        rows, size = _newton(model, rows, math.sqrt(limit))
        over_scales = np.asarray(np.linalg.inv(np.eye(len(size)) - size))
        limit, left, right = _limit(model, over_scales.sum(axis=1)), rows.position[:-1], rows.position[1:]
        between, errors = evaluate_midpoints(_scale(model, rows).rows, rows, left, right)
        is_accurate = _accumulated(errors + model.tolerance, over_scales) <= model.accuracy / 2
        if is_accurate or rows.position.size == first.size:  # before refinement: on a poor mesh it would not end
            _check_mesh(model, rows, between, over_scales)
        if is_accurate:
            return ComplianceTable(rows, model.infinite_amplitude, math.inf)
        rows = merge(rows, Rows(*(column[errors > limit] for column in between)))
    raise accuracy_error(float(np.max(errors)), rows, limit)


def _accumulated(errors: Array, over_scales: Array) -> float:
    """Return the largest relative error of the table from the errors of a scale in its cells, shape (cells,)."""
    adjacent = np.maximum(np.append(errors, 0), np.append(0, errors))  # each row has a cell on either side
    return float(np.max(over_scales @ adjacent))


def _check_mesh(model: Model, rows: Rows, between: Rows, over_scales: Array) -> None:
    """Raise ConvergenceError if the waves in the middle of the cells differ too much on 3/2 times the points."""
    mesh = midpoints(3 * model.mesh.rise.size // 2)
    finer = _scale(model._replace(mesh=mesh), rows).rows(between.position, None)
    error = _accumulated(np.abs(finer.log_compliance - between.log_compliance), over_scales)
    if not error <= MAX_MESH_ERROR:
        raise ConvergenceError(
            f"the mesh of the layer model changes the compliance by {error:.1e} of itself, above {MAX_MESH_ERROR:g}: "
            "choose more points, or a D further from 2",
            error,
        )


def _top(model: Model) -> float:
    """Return the ln xi at which tables end: above it the first wave is practically flat.

    No pressure in a wave exceeds 1 + xi, so that the table of its layer extends far enough.
    """
    step = model.log_pressure
    self_contained = -step - math.log(-math.expm1(-step))
    return max(self_contained, -0.5 * math.log(model.accuracy))


def _limit(model: Model, gain: Array) -> float:
    """Return the relative error of the table per scale that adds up, with the residuals, to half of the accuracy.

    The terms left out of a finite series have the other half.
    """
    scales = 1 + float(np.max(gain))
    if not scales <= MAX_SCALES:
        raise ConvergenceError(
            f"errors of the layer model add up over {scales:.0f} scales for D = {model.D:.9g} and gamma = "
            f"{model.gamma:.9g}, and {MAX_SCALES} are the most: take a finite m, a larger gamma or a smaller D",
            math.inf,
        )
    return model.accuracy / 2 / scales - model.tolerance


def _scale(model: Model, rows: Rows) -> Scale:
    """Return a wave on the layer with this table."""
    return Scale(model, coarser_units(rows.closure, model), model.infinite_amplitude, math.inf)


def _guess(model: Model, position: Array) -> Rows:
    """Return a table near the fixed point: Archard's estimate."""
    log_W = np.log(archard.compliance(np.exp(log_load_at(position)), model.D, model.gamma, math.inf))
    return Rows(position, log_W, np.gradient(log_W, position), np.empty((position.size, 0)))


def _newton(model: Model, rows: Rows, limit: float) -> tuple[Rows, Array]:
    """Solve by Newton steps with the J of the linear interpolant of ln W.

    J >= 0 and its rows sum to less than 1, so that (I - J)^-1 exists. Steps are shortened to `MAX_STEP`, and halved
    if a wave does not converge on the new table. Returns the rows at the fixed point and J, once a step is at most
    the limit.
    """
    identity, top = np.eye(rows.position.size), math.log(model.infinite_amplitude)
    spline = scipy.interpolate.CubicSpline(rows.position, identity)  # the rows also determine ln W between them
    image, correction, part, size, change = rows, np.zeros(len(identity)), 1.0, identity, math.inf
    for _ in range(MAX_STEPS):
        log_W = np.minimum(image.log_compliance + part * correction, top)
        slope = image.slope + spline(rows.position, 1) @ (log_W - image.log_compliance)
        rows = image._replace(log_compliance=log_W, slope=np.maximum(slope, 0))
        scale = _scale(model, rows)
        try:
            new = scale.rows(rows.position, rows.state if rows.state.size else None)
        except ConvergenceError:
            if np.all(np.abs(part * correction) <= limit):
                raise
            part /= 2
            continue
        if change <= limit and part == 1:
            return rows, size
        size = _sensitivity(new, scale)
        residual = new.log_compliance - log_W
        step = np.linalg.solve(identity - size, residual)
        change = float(np.max(np.abs(step)))
        image, correction, part = new, step * MAX_STEP / max(change, MAX_STEP) - residual, 1.0
    raise ConvergenceError(
        f"the layer model of the infinite series of D = {model.D:.6g} and gamma = {model.gamma:.6g} still changes by "
        f"{change:.1e} of itself from step to step, above {limit:.1e}: choose other points, or a D further from 2",
        change,
    )


def _sensitivity(image: Rows, scale: Scale) -> Array:
    """Return J = d ln TW/d ln W for ln W that is linear between the rows, shape (waves, rows)."""
    sensitivity, log_pressure = closure_sensitivity(
        image.state, log_load_at(image.position), scale.closure, scale.model.mesh, np.exp(image.log_compliance)
    )
    position, _ = position_in(scale.closure, log_pressure)
    linear = scipy.interpolate.make_interp_spline(image.position, np.eye(image.position.size), k=1)
    return np.stack([np.abs(own) @ linear(at) for own, at in zip(sensitivity, position, strict=True)])
