"""The method of the non-linear layer (4.3): curves of compliance and resistance.

docs/layer.md: "Tables" (range of the tables, heavier loads), "The whole series" (when a series counts as infinite),
"Error and limits".
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.kernels.blas import one_thread
from weier.methods import westergaard
from weier.methods.curve import Curve
from weier.methods.errors import ConvergenceError
from weier.methods.layer.fixed_point import infinite_waves
from weier.methods.layer.scales import MAX_SCALES, ComplianceTable, Model, finer_waves, model_of, scale_on
from weier.methods.layer.scaling_tables import BOTTOM_POSITIONS, MIN_LOADS, log_load_at
from weier.methods.method import CURVE_SECONDS, Method, Range, Setting, Style
from weier.surface.loads import checked_loads
from weier.surface.profile import Profile
from weier.surface.series import tail_amplitude

POINTS = 24  # error of the compliance 5e-6 of the total amplitude (docs/layer.md, "Error and limits")
ACCURACY = 1e-5
POINTS_RANGE = Range(4, 500)  # 40 loads on 384 points take 3 s, growing as the cube
ACCURACY_RANGE = Range(1e-9, 1e-2)  # an accuracy of 1e-2 adds few rows to the initial ones
INFINITE_TERMS = 11  # The tables of an infinite series take as long as the tables of this number of terms.


def curve(profile: Profile, mean_pressure: ArrayLike, points: int = POINTS, accuracy: float = ACCURACY) -> Curve:
    """Return compliance and resistance of the non-linear layer model (4.3).

    Parameters
    ----------
    profile : Profile
        A series of any number of terms, also inf; its phases do not matter.
    mean_pressure : array_like, shape (loads,)
        Increasing mean pressures, in p_0*.
    points : int
        Nodes on half a wave.
    accuracy : float
        Largest relative error of the compliance due to the tables of all scales, at any load. The error of the mesh
        is additional.

    Raises
    ------
    ConvergenceError
        If a wave does not converge, a table misses the accuracy (errors add up over 1/(1 - gamma^(D-2)) scales or
        more), or a series of too many terms still differs from the infinite one.

    Notes
    -----
    The residual is that of the coarsest wave. docs/layer.md, "Error and limits", has the errors of the mesh.

    """
    loads = checked_loads(mean_pressure)
    if loads[0] < MIN_LOADS[1]:
        raise ValueError(f"mean_pressure must be at least {MIN_LOADS[1]:g} p_0*, got {loads[0]:g}")
    if profile.m == 1:
        return Curve(westergaard.compliance(loads), westergaard.resistance(loads), residual=np.zeros(loads.size))
    model = model_of(profile.D, float(profile.gamma), profile.m, points, accuracy)
    light, others = np.split(loads, [np.searchsorted(loads, MIN_LOADS[0])])  # tables for light loads begin lower
    parts = zip((others, light), BOTTOM_POSITIONS, strict=True)
    solved = [_solve(some, bottom, model) for some, bottom in parts if some.size]
    h, R, residual = (np.concatenate(columns) for columns in zip(*reversed(solved), strict=True))
    return Curve(h, R, residual=residual)


@one_thread
def _solve(loads: Array, bottom: float, model: Model) -> tuple[Array, Array, Array]:
    """Return h, R and the residual of the coarsest wave under these loads, on the layer of all finer ones.

    The number of flattened waves of the infinite series is such that the load on the next one lies within the table.
    At the end of the table the pressure varies so little along a wave that w(p) is linear.
    """
    waves = _finer_waves(bottom, model)
    excess = np.log(loads) - log_load_at(waves.rows.position[-1])
    most = 0.0 if math.isfinite(waves.log_full) else math.inf
    flat = np.clip(np.ceil(excess / model.log_pressure), 0.0, most)
    scale = np.exp(flat * model.log_height)  # h = sum of the flat amplitudes + scale * h(xi)
    h, rate, residual = scale_on(waves, model).solve(np.log(loads) - flat * model.log_pressure)
    return (1 - scale) * waves.amplitude + scale * h, scale * rate / loads, scale * residual


def _finer_waves(bottom: float, model: Model) -> ComplianceTable:
    """Return the waves finer than the first, on tables that depend on no load."""
    tail = float(tail_amplitude(model.m, model.D, model.gamma))  # bounds the change of every compliance
    negligible = model.accuracy / 2  # the tables of the infinite series have the other half
    # ln W approaches -2 sqrt((2 - D) ln gamma |ln xi|) at light loads
    if tail <= negligible * math.exp(-2 * math.sqrt(model.log_height * log_load_at(bottom))):
        waves = infinite_waves(model, bottom)
        if tail <= negligible * math.exp(waves.rows.log_compliance[0]):
            return waves
    if model.m > MAX_SCALES + 1:
        raise ConvergenceError(
            f"a series of {model.m} terms still differs from the infinite one, and the layer model takes at most "
            f"{MAX_SCALES} scales one by one: choose a smaller m, or m = inf",
            tail / model.infinite_amplitude,
        )
    return finer_waves(model, bottom)


def _seconds(profile: Profile, loads: Array, points: int = POINTS, **settings: Any) -> float:
    """Return the expected seconds of the tables of all terms but the finest."""
    terms = profile.m if math.isfinite(profile.m) else INFINITE_TERMS
    return CURVE_SECONDS + 6e-4 * (terms - 1) * points


METHOD = Method(
    name="layer",
    label="non-linear layer",
    summary="each wave bears on a non-linear layer of all finer ones (4.3); any m, also inf",
    solve=curve,
    returns=("residual",),
    settings={
        "points": Setting(POINTS, "nodes per half wave, from {:g} to {:g}".format(*POINTS_RANGE), POINTS_RANGE),
        "accuracy": Setting(
            ACCURACY,
            "relative error of h by the tables of finer waves, from {:g} to {:g}".format(*ACCURACY_RANGE),
            ACCURACY_RANGE,
        ),
    },
    infinite=True,
    least_load=MIN_LOADS[1],
    uses_phases=False,
    in_paper=True,
    style=Style("#009E73", (1.2, 1.2), "s"),
    seconds=_seconds,
)
