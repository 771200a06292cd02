"""What a claim of the paper comes to on the cases of a scene: one function a claim measures, words and judges.

The numerical curve is that of the most accurate method a case has.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray as xr

from weier.kernels.arrays import Array, Flags
from weier.pipeline import curves
from weier.pipeline.claims.readings import (
    HALF,
    ROUNDING,
    MissingError,
    curve,
    describe,
    extreme,
    listed,
    loads_of,
    low_and_high,
    need,
    numerical,
    partial,
    percent,
    span,
    total_of,
)
from weier.theory.bounds import compliance_bounds, resistance_bounds
from weier.theory.series import tail_amplitude

Cases = Sequence[xr.Dataset]

# What the paper's words are taken to mean.
AGREE_CLOSELY = 0.1  # relative to the compliance itself, which no plot shows at light loads
CLOSE = 0.05  # "fairly close", "good results", "relatively small": of the compliance at full contact
EXTREMELY_SMALL = 0.02  # of the compliance at full contact
ALIGNED = np.pi / 6  # "close to zero and pi": no farther from them than this
NOT_LIGHT = 0.1  # p_0*: at lighter loads the curves of different phases start from different heights
# Of the compliance at full contact. Below, one contact carries all; above, the resistance vanishes: no ratio has a
# meaning.
INTERMEDIATE = (0.1, 0.9)
DEMELIO_ERROR = 0.30  # of the resistance, in the paper: "by as much as"
LAYER_ERROR = 0.12  # of the resistance, in the paper: "about"
ABOUT = 1.25  # "as much as 30%", "about 12%": up to this times that
NOISE = 1e-3  # g_0: the error of the boundary elements; a smaller difference has no sign

CRITERIA = (
    "Excess and error are of an estimate over the numerical curve. "
    f"Loads are low up to {HALF:.0%} of the compliance at full contact, high above. "
    f"Close means within {CLOSE:.0%} of the compliance at full contact, extremely small {EXTREMELY_SMALL:.0%}; "
    f"the few elements agree closely within {AGREE_CLOSELY:.0%} of the compliance itself. "
    f"Resistances are compared between {INTERMEDIATE[0]:.0%} and {INTERMEDIATE[1]:.0%} of the compliance at full "
    "contact: below, one contact carries all, and above, the resistance vanishes, so that no ratio has a meaning."
)


class Measured(NamedTuple):
    """What a claim found, in words and as a number, and whether the paper's words fit: None if nothing was found."""

    text: str
    value: float = np.nan
    holds: bool | None = None


def few_elements(cases: Cases) -> Measured:
    """A few elements against Eq. (12): the relative error with one in contact, and with more."""
    (case, *_) = cases
    h, exact, fraction = curve(case, "bem"), curve(case, "westergaard"), curve(case, "bem", "contact_fraction")
    points = float(case["points"].values[case["solution_method"].values.tolist().index("bem")])
    single = points * fraction < 1.5
    need(single.any() and not single.all(), "loads with one element in contact and loads with more")
    error = h / exact - 1
    one, more = extreme(error[single]), extreme(error[~single])
    text = (
        f"{points:.0f} elements: error of at most {more:+.1%} with more than one element in contact, "
        f"of {one:+.1%} with one (up to {loads_of(case)[single].max():.2g} p_0*)."
    )
    return Measured(text, abs(more), bool(abs(more) < AGREE_CLOSELY < abs(one)))


class Discretisation(NamedTuple):
    """Error of the boundary elements: largest of the compliance in g_0, relative ones of the resistance."""

    compliance: float
    resistance: Array
    ratio: float  # of the largest relative errors of both


def boundary_elements(cases: Cases) -> Measured:
    """The error of the boundary elements themselves, against the exact contact edges."""
    found = [_discretisation(case) for case in cases]
    text = listed(
        f"{describe(case)}: compliance within {error.compliance:.1g} g_0, resistance within "
        f"{np.median(error.resistance):.2%} for half of the loads and {error.resistance.max():.0%} for all"
        for case, error in zip(cases, found, strict=True)
    )
    least = min(error.ratio for error in found)
    return Measured(text, least, least > 1)


def _discretisation(case: xr.Dataset) -> Discretisation:
    seen = partial(case)
    miss = float(np.abs(curve(case, "bem") - curve(case, "patches")).max())
    R, exact = (curve(case, method, "resistance")[seen] for method in ("bem", "patches"))
    off = np.abs(R / exact - 1)
    return Discretisation(miss, off, float(off.max() / (miss / total_of(case))))


class PhaseSpread(NamedTuple):
    """The curves of all phases at one gamma, as parts of the compliance at full contact."""

    spread: Array  # between the highest and the lowest curve, over the loads
    off: Array  # largest distance of each phase from the average
    angle: Array  # each phase, from 0 to pi
    aligned: Flags  # whether it is close to zero or pi


def phase_spread(cases: Cases) -> Measured:
    """How far the curves of different phases lie from each other and from their average, for two gamma."""
    groups = sorted(curves.groups(cases, "gamma"), key=lambda group: float(group[0]["gamma"]))
    need(len(groups) > 1, "phases for two values of gamma")
    ends = groups[0], groups[-1]
    coarse, fine = (_spread(group) for group in ends)
    text = " ".join(_told(*end) for end in zip(ends, (coarse, fine), strict=True))
    widest = float(fine.spread.max())
    holds = coarse.off[~coarse.aligned].max() < CLOSE < coarse.off[coarse.aligned].max() and widest < EXTREMELY_SMALL
    return Measured(text, widest, bool(holds))


def _spread(cases: Cases) -> PhaseSpread:
    h, total = np.array([numerical(case) for case in cases]), total_of(cases[0])
    angle = np.array([curves.phase_angle(case) for case in cases])
    aligned = np.minimum(angle, np.pi - angle) <= ALIGNED + ROUNDING
    need(aligned.any() and not aligned.all(), "phases close to zero or pi and phases between")
    return PhaseSpread(np.ptp(h, axis=0) / total, np.abs(h - h.mean(axis=0)).max(axis=1) / total, angle, aligned)


def _told(cases: Cases, found: PhaseSpread) -> str:
    loads, total = loads_of(cases[0]), total_of(cases[0])
    widest, heavy = int(found.spread.argmax()), loads >= NOT_LIGHT
    return (
        f"gamma = {float(cases[0]['gamma']):g}: the curves spread over up to {total * found.spread[widest]:.2g} g_0, "
        f"{found.spread[widest]:.1%} of full contact, at {loads[widest]:.2g} p_0*"
        + (f" ({total * found.spread[heavy].max():.2g} g_0 from {NOT_LIGHT:g} p_0* on)" if heavy.any() else "")
        + f"; the phase farthest from their average is {found.angle[found.off.argmax()] / np.pi:.2g} pi, "
        f"by {total * found.off.max():.2g} g_0, "
        f"and those not close to zero and pi stay within {total * found.off[~found.aligned].max():.2g} g_0."
    )


def archard_above(cases: Cases) -> Measured:
    """Archard's compliance less the numerical one, in partial contact."""
    found = [(curve(case, "archard") - numerical(case))[partial(case)] for case in cases]
    text = listed(
        f"{describe(case)}: {span(excess)} g_0 in partial contact" for case, excess in zip(cases, found, strict=True)
    )
    least = float(min(excess.min() for excess in found))
    return Measured(text, least, least > -NOISE)


class Crossing(NamedTuple):
    """Demelio's compliance less the numerical one, in g_0, at low loads; and the loads where it is above, in p_0*."""

    low: Array
    above: Array


def demelio_below(cases: Cases) -> Measured:
    """Demelio's compliance less the numerical one at low loads, and from where on it is above."""
    found = [_crossing(case) for case in cases]
    text = listed(
        f"{describe(case)}: {span(excess.low)} g_0 at low loads, "
        + (f"above from {excess.above.min():.2g} p_0* on" if excess.above.size else "nowhere above")
        for case, excess in zip(cases, found, strict=True)
    )
    highest = float(max(excess.low.max() for excess in found))
    return Measured(text, highest, highest < 0)


def _crossing(case: xr.Dataset) -> Crossing:
    low, _ = low_and_high(case)
    excess = curve(case, "demelio") - numerical(case)
    return Crossing(excess[low], loads_of(case)[excess > NOISE])


class LayerExcess(NamedTuple):
    """The layer's compliance less the numerical one, in g_0."""

    low: Array  # at low loads
    high: Array  # at high loads
    worst: float  # at low loads, of the compliance at full contact


def layer_close(cases: Cases) -> Measured:
    """The layer's compliance less the numerical one, at low and at high loads."""
    found = [_layer_excess(case) for case in cases]
    text = listed(
        f"{describe(case)}: {span(excess.low)} g_0 at low loads ({excess.worst:.1%} of full contact), "
        f"{span(excess.high)} g_0 at high loads with a mean of {excess.high.mean():+.1g} g_0"
        for case, excess in zip(cases, found, strict=True)
    )
    worst = max(excess.worst for excess in found)
    return Measured(text, worst, worst < CLOSE and all(excess.high.mean() < 0 for excess in found))


def _layer_excess(case: xr.Dataset) -> LayerExcess:
    low, high = low_and_high(case)
    excess = curve(case, "layer") - numerical(case)
    return LayerExcess(excess[low], excess[high], float(np.abs(excess[low]).max() / total_of(case)))


def errors_grow_with_dimension(cases: Cases) -> Measured:
    """The largest error of each estimate, of the compliance at full contact, for the least and the largest D."""
    ordered = sorted(cases, key=lambda case: float(case["D"]))
    need(ordered and ordered[0]["D"] < ordered[-1]["D"], "cases of two values of D")
    ends = ordered[0], ordered[-1]
    errors = {method: [_largest_error(case, method) for case in ends] for method in curves.ESTIMATES}
    shown = ", ".join(f"{method} {less:.1%} and {more:.1%}" for method, (less, more) in errors.items())
    text = f"Largest error of full contact for D = {float(ends[0]['D']):g} and {float(ends[1]['D']):g}: {shown}."
    growth = min(more / less for less, more in errors.values())
    return Measured(text, growth, growth > 1)


def _largest_error(case: xr.Dataset, method: str) -> float:
    return float(np.abs(curve(case, method) - numerical(case)).max() / total_of(case))


class ResistanceErrors(NamedTuple):
    """Relative errors of each estimate of the resistance, over loads of intermediate compliance, in p_0*."""

    loads: Array
    of: dict[str, Array]


def resistance_errors(cases: Cases) -> Measured:
    """Extremes of the relative error of each estimate of the resistance, at intermediate compliance."""
    found = [_resistance_errors(case) for case in cases]
    text = listed(
        f"{describe(case)}: "
        + ", ".join(f"{method} {percent(error)} (mean {error.mean():+.0%})" for method, error in errors.of.items())
        + f" from {errors.loads[0]:.2g} to {errors.loads[-1]:.2g} p_0*"
        for case, errors in zip(cases, found, strict=True)
    )
    worst = float(max(np.abs(errors.of["layer"]).max() for errors in found))
    return Measured(text, worst, all(_as_the_paper_says(errors) for errors in found))


def _resistance_errors(case: xr.Dataset) -> ResistanceErrors:
    part = numerical(case) / total_of(case)
    seen = (part >= INTERMEDIATE[0]) & (part <= INTERMEDIATE[1])
    need(seen.any(), "loads of intermediate compliance")
    exact = numerical(case, "resistance")[seen]
    errors = {method: curve(case, method, "resistance")[seen] / exact - 1 for method in curves.ESTIMATES}
    return ResistanceErrors(loads_of(case)[seen], errors)


def _as_the_paper_says(errors: ResistanceErrors) -> bool:
    archard, demelio, layer = (errors.of[method] for method in ("archard", "demelio", "layer"))
    high = errors.loads >= np.median(errors.loads)
    size = {method: np.sqrt(np.mean(error**2)) for method, error in errors.of.items()}
    archard_too_low = archard[high].mean() < 0
    demelio_too_high = demelio.min() > -CLOSE and demelio.max() < ABOUT * DEMELIO_ERROR
    layer_best = min(size, key=size.__getitem__) == "layer" and np.abs(layer).max() < ABOUT * LAYER_ERROR
    return bool(archard_too_low and demelio_too_high and layer_best)


def last_term(cases: Cases) -> Measured:
    """How much each further term moves the mean gap, and what the bounds theorem allows the last."""
    ordered = sorted(cases, key=lambda case: float(case["m"]))
    need(len(ordered) > 1, "series of two lengths")
    gap = [total_of(case) - numerical(case) for case in ordered]
    moved = [float(np.abs(more - less).max()) for less, more in pairwise(gap)]
    last, before = total_of(ordered[-1]), total_of(ordered[-2])
    part = moved[-1] / last
    steps = ", ".join(f"{v:.2g} g_0 from m = {float(c['m']):g}" for v, c in zip(moved, ordered, strict=False))
    text = (
        f"One more term moves the mean gap by up to {steps}; the last step is {part:.1%} of full contact, and the "
        f"bounds theorem allows it {last - before:.2g} g_0."
    )
    return Measured(text, part, part < CLOSE and moved[-1] == min(moved))


class Places(NamedTuple):
    """Where the estimates lie between the bounds from the one-wave solution."""

    farthest: dict[str, float]  # of each from the middle of the bounds, over their half-width
    resistances_within: bool


def one_wave_bounds(cases: Cases) -> Measured:
    """Where the estimates lie between the bounds that the one-wave solution gives for the endless series.

    Notes
    -----
    Counted from the mean plane, the endless series lies within G_1 of the one-wave solution, and one of m terms,
    which the estimates here are of, within g_1 + ... + g_(m-1) < G_1.
    """
    one = next((case for case in cases if float(case["m"]) == 1), None)
    longer = [case for case in cases if float(case["m"]) > 1]
    if one is None or not longer:
        raise MissingError("there are no one-wave solution and longer series")
    exact = curves.curve(one, "compliance", "westergaard")
    wave = numerical(one) if exact is None else exact
    found = [_places(case, wave) for case in longer]
    text = listed(
        f"{describe(case)}: farthest from the one-wave solution, of G_1, are "
        + ", ".join(f"{method} {place:.0%}" for method, place in places.farthest.items())
        + f"; the resistances lie {'within' if places.resistances_within else 'not all within'} its bounds"
        for case, places in zip(longer, found, strict=True)
    )
    farthest = max(place for places in found for place in places.farthest.values())
    holds = farthest <= 1 + ROUNDING and all(places.resistances_within for places in found)
    return Measured(text, farthest, holds)


def _places(case: xr.Dataset, wave: Array) -> Places:
    tail = float(tail_amplitude(1, float(case["D"]), float(case["gamma"])))
    lower, upper = compliance_bounds(wave - 1, tail)
    low, high = resistance_bounds(loads_of(case), wave, tail, 0.0)
    farthest, within = {}, True
    for method in curves.ESTIMATES:
        h, resistance = curve(case, method) - total_of(case), curve(case, method, "resistance")
        farthest[method] = float(np.abs(2 * h - lower - upper).max() / (2 * tail))
        within &= bool(np.all((resistance >= low - ROUNDING) & (resistance <= high + ROUNDING)))
    return Places(farthest, within)
