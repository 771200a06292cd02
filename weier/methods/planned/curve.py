"""The method "planned", which runs the plan of a profile: each part by its method, an error for every number."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.methods import bem, demelio, laws, layer, patches, westergaard
from weier.methods import hybrid as endless
from weier.methods.errors import OutOfReachError
from weier.methods.planned.plan import TOLERANCE, plan
from weier.methods.planned.segment import Part
from weier.theory.bounds import chord_bounds, complete_bounds
from weier.theory.profile import Profile
from weier.theory.terms import left_out, truncated

Array = NDArray[np.float64]


ROUNDING = 1e-9  # of a tolerance, to which the errors foreseen and those found add up alike
METHOD_NAME = "<U12"  # as long as the longest of them


class Curve(NamedTuple):
    """Planned curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    resistance : dh/dp, in g_0/p_0*
    compliance_error, resistance_error : expected, in the same units
    planned_method, planned_terms, planned_points : what was taken at each load; no points where there is no grid
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array
    planned_method: NDArray[np.str_]
    planned_terms: Array
    planned_points: Array


class Solved(NamedTuple):
    """The terms that are modelled, in their own datum, and how far off; resistance_error is inf where unknown."""

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array


def curve(
    profile: Profile, mean_pressure: Array, tolerance: float = TOLERANCE, quantity: str = "compliance"
) -> Curve:
    """Plan and run: see `weier.plan`.

    Parameters
    ----------
    profile : Profile
        With any number of terms.
    mean_pressure : array, shape (loads,)
        Increasing, in p_0*.
    tolerance, quantity
        As in `weier.plan`.

    Returns
    -------
    Curve
        Arrays over the loads.

    Raises
    ------
    ValueError
        If the tolerance is out of reach, foreseen or found.
    ConvergenceError
        If a solver misses its own tolerance.

    Notes
    -----
    The numbers of a load do not depend on the other loads, but for what iterations leave within their residuals.
    The error of a compliance is that of the discretisation, by the law of the method or from the residual that it
    left, and half of what the bounds theorem leaves open between h_k and full contact. The error of a resistance is
    that of the method where all terms are modelled, or what the chords of a concave curve within the errors of the
    compliance allow, if that is less: those to no load, and to the loads that a plan for the resistance solves beside
    each one that it was asked for.
    """
    return _within(profile, mean_pressure, tolerance, quantity, ())


def _within(profile: Profile, loads: Array, tolerance: float, quantity: str, failed: tuple[Part, ...]) -> Curve:
    """Plan and run; where errors are found above the tolerance, again without what left them.

    Raises
    ------
    OutOfReachError
        If nothing is left to try, or was in reach.
    """
    found = []
    for part in plan(profile, loads, tolerance, quantity, failed).parts:
        values = run(profile, (part,))
        off = values.compliance_error if quantity == "compliance" else _relative_error(values)
        missed = ~(off <= tolerance * (1 + ROUNDING))
        if missed.any():
            try:
                again = _within(profile, part.mean_pressure[missed], tolerance, quantity, (*failed, part))
            except OutOfReachError as error:
                raise OutOfReachError(
                    f"{error}; {part.method} with {part.terms:g} terms was expected to do, and left an error of "
                    f"{off[missed].max():.2g} at {part.mean_pressure[missed][off[missed].argmax()]:g} p_0*"
                ) from None
            for old, new in zip(values, again, strict=True):
                old[missed] = new
        found.append(values)
    return Curve(*(np.concatenate(columns) for columns in zip(*found, strict=True)))


def _relative_error(found: Curve) -> Array:
    return found.resistance_error / np.maximum(found.resistance, 1)


def run(profile: Profile, parts: tuple[Part, ...]) -> Curve:
    """Run parts that cover the loads one after the other.

    Raises
    ------
    ConvergenceError
        If a solver misses its own tolerance.
    """
    rows = [_solved(profile, part) for part in parts]
    h, R, miss, rough = (np.concatenate(columns) for columns in zip(*rows, strict=True))
    counts = [part.mean_pressure.size for part in parts]
    points = [part.settings.get("points", np.nan) for part in parts]
    return Curve(
        h,
        R,
        miss,
        rough,
        np.repeat(np.array([part.method for part in parts], METHOD_NAME), counts),
        np.repeat([float(part.terms) for part in parts], counts),
        np.repeat(np.array(points, float), counts),
    )


def _solved(profile: Profile, part: Part) -> Solved:
    """One part for the whole series, its resistance held by the chords of each load to the others it brings."""
    p = part.mean_pressure
    others = np.empty((p.size, 0)) if part.chord_loads is None else part.chord_loads
    loads, place = np.unique(np.column_stack([p, others]), return_inverse=True)
    place = place.reshape(p.size, -1)
    found = part if part.chord_loads is None else part._replace(mean_pressure=loads)
    h, R, miss, rough = (values[place] for values in _completed(profile, found, RUN[part.method](profile, found)))
    off = miss + laws.FLOOR * h
    low, high = chord_bounds(p, h[:, 0], off[:, 0], others, np.array([h[:, 1:], off[:, 1:]]))
    between = np.clip(R[:, 0], low, high)
    steep = np.maximum(high - between, between - low)
    known = rough[:, 0] <= steep
    return Solved(h[:, 0], np.where(known, R[:, 0], between), miss[:, 0], np.where(known, rough[:, 0], steep))


def _completed(profile: Profile, part: Part, found: Solved) -> Solved:
    """The same for the whole series: the middle of what the terms left out can make of it."""
    if part.whole:
        return found
    low, high = complete_bounds(found.compliance, left_out(profile, part.terms), profile.total_amplitude)
    room = high - low
    whole = part.terms == profile.m
    return Solved(
        found.compliance + room / 2,
        found.resistance,
        found.compliance_error + room / 2,
        found.resistance_error if whole else np.full(room.size, np.inf),
    )


def _demelio(profile: Profile, part: Part) -> Solved:
    loads, series = part.mean_pressure, (profile.D, float(profile.gamma), profile.m)
    h, R = demelio.compliance(loads, *series), demelio.resistance(loads, *series)
    return Solved(h, R, part.error, np.full(loads.size, np.inf))


def _layer(profile: Profile, part: Part) -> Solved:
    law = layer.curve(part.mean_pressure, profile.D, float(profile.gamma), profile.m)
    return Solved(law.compliance, law.resistance, part.error, np.full(part.mean_pressure.size, np.inf))


def _on_layer(profile: Profile, part: Part) -> Solved:
    """The estimate, with the least of what its law and its certificate say."""
    found = endless.curve(profile, part.mean_pressure, int(part.terms), **part.settings)
    beside = np.maximum(found.compliance_upper - found.compliance, found.compliance - found.compliance_lower)
    unknown = np.full(beside.size, np.inf)
    return Solved(found.compliance, found.resistance, np.minimum(part.error, beside), unknown)


def _flat(profile: Profile, part: Part) -> Solved:
    none = np.zeros(part.mean_pressure.size)
    return Solved(none + truncated(profile, int(part.terms)).total_amplitude, none, none, none)


def _one_wave(_: Profile, part: Part) -> Solved:
    loads, none = part.mean_pressure, np.zeros(part.mean_pressure.size)
    return Solved(westergaard.compliance(loads), westergaard.resistance(loads), none, none)


def _on_grid(profile: Profile, part: Part) -> Solved:
    loads, kept = part.mean_pressure, truncated(profile, int(part.terms))
    grid = bem.curve(kept, loads, tolerance=laws.BEM_RESIDUAL, **part.settings)
    miss = laws.bem_compliance_error(kept, grid.points) + laws.RESIDUAL * grid.residual
    rough = laws.bem_resistance_error(kept, grid.points, loads) * np.maximum(grid.resistance, 1)
    light = laws.light_resistance_error(kept, grid.points, loads, grid.resistance)
    return Solved(grid.compliance, grid.resistance, miss, np.where(np.isinf(rough), light, rough))


def _by_contacts(profile: Profile, part: Part) -> Solved:
    kept = truncated(profile, int(part.terms))
    exact = patches.curve(kept, part.mean_pressure, **part.settings)
    miss = laws.RESIDUAL * exact.residual + laws.FLOOR * kept.total_amplitude
    rough = laws.patches_error(part.settings["tolerance"], "resistance") * np.maximum(exact.resistance, 1)
    flat = exact.patch_count == 0
    return Solved(exact.compliance, exact.resistance, np.where(flat, 0, miss), np.where(flat, 0, rough))


RUN: dict[str, Callable[[Profile, Part], Solved]] = {
    "full contact": _flat,
    "westergaard": _one_wave,
    "demelio": _demelio,
    "layer": _layer,
    "endless": _on_layer,
    "bem": _on_grid,
    "patches": _by_contacts,
}
