"""The claims of the paper: each statement, and its interpretation as numbers of a profile and their limits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise

import numpy as np

from weier.data import curves
from weier.kernels.arrays import Array
from weier.methods.registry import find_method
from weier.pipeline.claims.claim import (
    MIN_FRACTION,
    MIN_MEMBERS,
    OPEN_FACTOR,
    Case,
    Cases,
    Claim,
    Ensemble,
    Number,
)
from weier.pipeline.claims.measures import (
    PARTIAL,
    ROUNDING,
    between,
    by_mean,
    by_phases,
    curve,
    describe,
    errors_of_resistance,
    excess,
    mean,
    need,
    numerical,
    partial_contact,
    ratio,
    resistance_of_independent_contacts,
    series,
    stated_error,
)
from weier.surface.profile import PARAMETERS
from weier.surface.series import full_contact_pressure, tail_amplitude
from weier.theory.bounds import resistance_bounds

ESTIMATES = ("archard", "demelio", "layer")  # the approximations of Section 4
# Limits that quantify words of the paper.
CLOSE_AGREEMENT = 0.1  # Relative errors below this are not visible in a plot at light loads.
CLOSE = 0.05  # quantifies "fairly close", "good results" and "relatively small", over full contact
EXTREMELY_SMALL = 0.02  # quantifies "extremely small", over full contact
DEMELIO_ERROR = 0.30  # relative error of the resistance in the paper: "by as much as"
LAYER_ERROR = 0.12  # relative error of the resistance in the paper: "about"
QUOTED_TOLERANCE = 1.25  # "As much as 30%" and "about 12%" allow up to this factor.
QUITE_GOOD = 0.1  # "Quite good" for h, over full contact; for R it means the 30 % given for Demelio.
LIGHT_LOAD = 0.01  # p_0*: as p -> 0, every estimate tends to 0, the exact compliance to its value at first contact
SAME_RATE = 1.1  # The area falls as gamma^(1-D) a term within this factor, which is within the scatter of phases.
MAX_ALIGNED_ANGLE = np.pi / 6  # largest distance of phases "close to zero and pi"
LOW_COMPLIANCE = 0.5  # boundary between low and high loads, as a fraction of the compliance at full contact
# Compliances over that at full contact, as PARTIAL: below both ranges, one contact carries the load. Above this one,
# the coarse waves are flat and the finest ones alone resist; above PARTIAL, the resistance itself vanishes.
INTERMEDIATE = (0.1, 0.9)

RULE = (
    "Each number is measured on profiles that differ in their phases alone, and a profile is too close to call where "
    f"its number lies between the limit and {OPEN_FACTOR:g} times the limit, within the stated error of the "
    "numerical curve of a change of sign, or closer to the limit than it changes if every second load is left out. A "
    "statement about all loads or profiles holds if every profile confirms it, and fails with the first that refutes "
    "it. A "
    f"tendency needs {MIN_FRACTION:.0%} of them for either. Otherwise it is not decided, and fewer than "
    f"{MIN_MEMBERS} profiles confirm nothing. Statements about smooth curves of the resistance are judged on the "
    "mean over the phases, since that of a single profile drops at births; single profiles are given as well."
)
MEANINGS = (
    "Excess and error are of an estimate over the numerical curve, and averages are over the load. "
    f"Loads are low up to {LOW_COMPLIANCE:.0%} of the compliance at full contact, and high above, resistances up to "
    f"{PARTIAL[1]:.0%} of it. "
    f"Close means within {CLOSE:.0%} of the compliance at full contact, quite good {QUITE_GOOD:.0%} of it and "
    f"{DEMELIO_ERROR:.0%} of the resistance, and extremely small within "
    f"{EXTREMELY_SMALL:.0%}; the few elements agree closely within {CLOSE_AGREEMENT:.0%} of the compliance itself. "
    f"Resistances by the estimates are compared between {PARTIAL[0]:.0%} and {PARTIAL[1]:.0%} of the compliance at "
    "full contact: below, one contact carries the load, and above, the resistance vanishes, so that ratios mean "
    f"nothing. Bounds and the effect of further terms are compared up to {INTERMEDIATE[1]:.0%}, above which the "
    "coarse waves are flat."
)


def claim(
    ensembles: Callable[[Cases], list[Ensemble]], statement: str
) -> Callable[[Callable[..., Iterator[Number]]], Claim]:
    """Make a claim of a function that yields the numbers of a member of an ensemble."""
    return partial(Claim, statement, ensembles)


@claim(
    by_phases,
    "Even with as few as 12 elements, the results agree closely with Eq. (12), except at very light loads where "
    "only one element is in contact (5.1).",
)
def twelve_elements(case: Case) -> Iterator[Number]:
    error = np.abs(curve(case, "bem") / curve(case, "westergaard") - 1)
    points = float(case["points"][case["solution_method"].tolist().index("bem")])
    single = points * curve(case, "bem", "contact_fraction") < 1.5
    need(single.any() and not single.all(), "loads with one element in contact and loads with more")
    what, limit = "largest relative error of the compliance with", CLOSE_AGREEMENT
    yield Number(f"{what} more than one element in contact", "%", error[~single].max(), "at most", limit)
    yield Number(f"{what} only one element in contact", "%", error[single].max(), "at least", limit)


def _coarse_and_fine(cases: Cases) -> list[Ensemble]:
    """Return two ensembles, gamma = 2 and 5, each with all phases as one member."""
    groups = {float(group[0]["gamma"]): group for group in curves.groups(cases, "gamma")}
    need(groups.keys() >= {2, 5}, "phases for gamma = 2 and 5")
    return [Ensemble(f"gamma = {gamma}", [groups[gamma]]) for gamma in (2, 5)]


@claim(
    _coarse_and_fine,
    "The curves for gamma = 2 lie fairly close to their average for all phases except those close to zero and "
    "pi; the effect of phase is extremely small at gamma = 5 (5.2).",
)
def phase_spread(*phases: Case) -> Iterator[Number]:
    h = np.array([numerical(case) / case["total_amplitude"] for case in phases])
    if phases[0]["gamma"] == 5:
        spread = np.ptp(h, axis=0).max()
        yield Number("largest spread of all curves, of full contact", "%", spread, "at most", EXTREMELY_SMALL)
        return
    angle = np.array([curves.phase_angle(case) for case in phases])
    close = np.minimum(angle, np.pi - angle) <= MAX_ALIGNED_ANGLE + ROUNDING
    need(close.any() and not close.all(), "phases close to zero or pi and phases between")
    distance, what = np.abs(h - h.mean(axis=0)), "largest distance from the average at"
    yield Number(f"{what} other phases, of full contact", "%", distance[~close].max(), "at most", CLOSE)
    yield Number(
        f"{what} phases close to zero and pi, of full contact", "%", distance[close].max(), "at least", CLOSE
    )


@claim(
    by_phases,
    "The Archard approximation overestimates the compliance at all values of load (5.3): at all but the "
    "lightest, where Archard's compliance tends to 0 and that of the surface to its value at first contact.",
)
def archard_above(case: Case) -> Iterator[Number]:
    off, error = excess(case, "archard"), stated_error("compliance", case)
    crossing = _load_of_crossing(case, off)
    yield Number("load above which Archard's compliance is too high", "p_0*", crossing, "at most", LIGHT_LOAD)
    what = "least excess of Archard's compliance over that from first contact"
    least = (off + float(case["first_contact"]))[partial_contact(case)].min()
    yield Number(what, "g_0", least, "at least", 0, error=error, decides=False)


def _load_of_crossing(case: Case, off: Array) -> float:
    """Return the load above which an excess is positive, in p_0*; the first one if it always is.

    Close to full contact, where all curves meet, the sign of the excess is not examined.
    """
    loads = case["mean_pressure"]
    below = np.flatnonzero((off < 0) & (numerical(case) < PARTIAL[1] * case["total_amplitude"]))
    if not below.size:
        return float(loads[0])
    last = int(below[-1])
    if last + 1 == loads.size:
        return float(loads[-1])
    return float(np.interp(0.0, off[last : last + 2], loads[last : last + 2]))


@claim(by_phases, "The Demelio approximation underestimates the compliance at low loads (5.3).")
def demelio_below(case: Case) -> Iterator[Number]:
    _, low = between(case, excess(case, "demelio"), 0, LOW_COMPLIANCE)
    error = stated_error("compliance", case)
    yield Number("largest excess of Demelio's compliance at low loads", "g_0", low.max(), "below", 0, error=error)


@claim(
    by_phases,
    "The non-linear layer model gives good results at low loads, but tends to underestimate the compliance "
    "slightly at high loads (5.3).",
)
def layer_close(case: Case) -> Iterator[Number]:
    off, error = excess(case, "layer"), stated_error("compliance", case)
    high = mean(*between(case, off, LOW_COMPLIANCE, 1))
    yield Number(
        "mean excess of the layer's compliance at high loads", "g_0", high, "below", 0, error=error, most=True
    )
    low = np.abs(between(case, off, 0, LOW_COMPLIANCE)[1]).max() / case["total_amplitude"]
    what = "largest error of the layer's compliance at low loads, of full contact"
    yield Number(what, "%", low, "at most", CLOSE, most=True)


@claim(
    partial(series, "D"),
    "The higher fractal dimension generally makes the approximations less accurate (5.3).",
)
def errors_grow_with_dimension(*dimensions: Case) -> Iterator[Number]:
    error = stated_error("compliance", *dimensions)
    for method in ESTIMATES:
        largest = [np.abs(excess(case, method)).max() / case["total_amplitude"] for case in dimensions]
        what = f"growth of the largest error of {find_method(method).label}, of full contact"
        yield Number(what, "%", largest[-1] - largest[0], "above", 0, error=error, most=True)


@claim(
    by_mean,
    "The Archard approximation tends to underestimate the resistance, particularly at high loads; the Demelio "
    "approximation consistently overestimates it, by as much as 30%; the non-linear layer is best, its largest "
    "error an overestimate of about 12% at intermediate loads (5.4).",
)
def resistance_errors(case: Case) -> Iterator[Number]:
    layer, demelio = (errors_of_resistance(case, method)[1] for method in ("layer", "demelio"))
    error = stated_error("resistance", case)
    what, limit = "largest relative error of the layer's resistance", QUOTED_TOLERANCE * LAYER_ERROR
    yield Number(what, "%", np.abs(layer).max(), "at most", limit)
    what = "largest overestimate of the layer's resistance less its largest underestimate"
    yield Number(what, "%", layer.min() + layer.max(), "above", 0, error=error, most=True)
    what = "root mean square error of R by the layer minus the better of the other estimates"
    yield Number(what, "%", _layer_minus_better(case), "below", 0, error=error, most=True)
    what = "root mean square error of R over ln p from the lightest load on, minus the better of the others"
    lightest = _layer_minus_better(case, lightest=True)
    yield Number(what, "%", lightest, "below", 0, error=error, most=True, decides=False)
    high = mean(*errors_of_resistance(case, "archard", LOW_COMPLIANCE))
    what = "mean relative error of Archard's resistance at high loads"
    yield Number(what, "%", high, "below", 0, error=error, most=True)
    what = "least relative error of Demelio's resistance"
    yield Number(what, "%", demelio.min(), "at least", 0, error=error)
    what, limit = "largest relative error of Demelio's resistance", QUOTED_TOLERANCE * DEMELIO_ERROR
    yield Number(what, "%", demelio.max(), "at most", limit)


def _layer_minus_better(case: Case, lightest: bool = False) -> float:
    """Return the rms error of R by the layer, minus the rms error by the better of the other estimates.

    With `lightest`, the range begins at the first load, and the mean is over the logarithm of the load.
    """
    size = []
    for method in ESTIMATES:
        loads, error = errors_of_resistance(case, method, 0.0 if lightest else PARTIAL[0])
        size.append(np.sqrt(mean(np.log(loads) if lightest else loads, error**2)))
    archard, demelio, layer = size
    return float(layer - min(archard, demelio))


@claim(by_phases, "All the curves show the typical reduction of contact resistance with increasing load (5.4).")
def resistance_falls(case: Case) -> Iterator[Number]:
    rows = [*(curve(case, method, "resistance") for method in ESTIMATES), numerical(case, "resistance")]
    rise = max((np.diff(row) / row.max()).max() for row in rows)
    what = "largest rise of a resistance from one load to the next, over its largest value"
    yield Number(what, "", rise, "at most", ROUNDING, factor=1)


@claim(
    by_phases,
    "The bounds on the resistance are less tight than those on the load-compliance relation (5.5).",
)
def bounds_looser(case: Case) -> Iterator[Number]:
    widths = []
    for quantity in ("resistance", "compliance"):
        width = numerical(case, f"{quantity}_upper") - numerical(case, f"{quantity}_lower")
        relative = width / np.maximum(numerical(case, quantity), ROUNDING)
        widths.append(mean(*between(case, relative, *INTERMEDIATE)))
    what = "relative width of the bounds on the resistance over that on the compliance"
    yield Number(what, "", widths[0] / widths[1], "at least", 1)


@claim(by_mean, "All the proposed approximations give quite good predictions of the curves (6).")
def approximations_good(case: Case) -> Iterator[Number]:
    for method in ESTIMATES:
        label = find_method(method).label
        h = mean(*between(case, np.abs(excess(case, method)), 0, 1)) / case["total_amplitude"]
        yield Number(f"mean error of the compliance by {label}, of full contact", "%", h, "at most", QUITE_GOOD)
        loads, error = errors_of_resistance(case, method)
        what = f"mean relative error of the resistance by {label}"
        yield Number(what, "%", mean(loads, np.abs(error)), "at most", DEMELIO_ERROR)


@claim(by_phases, "The numerical resistance is rather sensitive to discretization errors (5.4).")
def boundary_elements(case: Case) -> Iterator[Number]:
    contact = partial_contact(case)
    R, exact = (curve(case, method, "resistance")[contact] for method in ("bem", "patches"))
    of_compliance = np.abs(curve(case, "bem") - curve(case, "patches")).max() / case["total_amplitude"]
    what = "ratio of the largest relative errors of resistance and compliance by boundary elements"
    yield Number(what, "", np.abs(R / exact - 1).max() / of_compliance, "at least", 1)


@claim(partial(series, "m"), "Additional fine scale features have a relatively small effect (5.5).")
def fourth_term(*lengths: Case) -> Iterator[Number]:
    gaps = [case["total_amplitude"] - numerical(case) for case in lengths]
    *others, last = (np.abs(longer - shorter).max() for shorter, longer in pairwise(gaps))
    what = "largest change of the mean gap with the last term, of full contact"
    yield Number(what, "%", last / lengths[-1]["total_amplitude"], "at most", CLOSE)
    what = "largest change of the mean gap with the last term over the least with those before"
    yield Number(what, "", last / min(others, default=np.inf), "at most", 1)


@claim(
    partial(series, "m"),
    "The contact area reduces without limit as finer and finer scales are added (1), while stiffness and "
    "resistance are largely determined by the coarse scales (5.5, 6).",
)
def area_vanishes(*lengths: Case) -> Iterator[Number]:
    areas = [_area_ratio(shorter, longer) for shorter, longer in pairwise(lengths)]
    growth = max(area.max() for area in areas)
    what = "largest ratio of the contact areas with one more term and without it"
    yield Number(what, "", growth, "at most", 1, factor=1)
    rate = full_contact_pressure(1, float(lengths[-1]["D"]), float(lengths[-1]["gamma"]))  # gamma^(D-1)
    what = "factor of the area with the last term over gamma^(1-D), mean over the loads"
    yield Number(what, "", np.exp(np.log(areas[-1]).mean()) * rate, "at most", SAME_RATE, most=True)
    shorter, longer = (numerical(case, "resistance") for case in lengths[-2:])
    loads, change = between(lengths[-1], np.abs(ratio(longer, shorter) - 1), *INTERMEDIATE)
    what = "mean absolute relative change of the resistance with the last term"
    yield Number(what, "%", mean(loads, change), "at most", CLOSE, most=True)
    what = "largest relative change of the resistance with the last term"
    yield Number(what, "%", change.max(), "at most", CLOSE, decides=False)


def _area_ratio(shorter: Case, longer: Case) -> Array:
    """Return the ratios of the contact fractions of two series at the loads of partial contact of the shorter one."""
    contact = partial_contact(shorter)
    area: Array = numerical(longer, "contact_fraction")[contact] / numerical(shorter, "contact_fraction")[contact]
    return area


@claim(
    partial(series, "m"),
    "Classical asperity models predict continued change in contact resistance as more fine scale features are "
    "added (6), since the number of independent contacts times their size grows without limit (2).",
)
def independent_contacts(*lengths: Case) -> Iterator[Number]:
    fewer, more = (numerical(case, "patch_count") for case in lengths[-2:])
    growth = mean(*between(lengths[-1], more / np.maximum(fewer, 1), *INTERMEDIATE))
    yield Number("factor of the number of contacts with the last term, mean over the load", "", growth, "at least", 1)
    shorter, longer = map(resistance_of_independent_contacts, lengths[-2:])
    with np.errstate(divide="ignore", invalid="ignore"):  # full contact is excluded below
        logarithm = np.log(longer / shorter)
    factor = np.exp(mean(*between(lengths[-1], logarithm, *INTERMEDIATE)))
    what = "factor of the resistance of independent contacts with the last term"
    yield Number(what, "", factor, "at most", 1 - DEMELIO_ERROR, factor=1)


def _with_one_wave(cases: Cases) -> list[Ensemble]:
    """Return one case of each longer series (the estimates are independent of phases) and the one-wave solution."""
    waves = [case for case in cases if case["m"] == 1]
    longer = curves.groups([case for case in cases if case["m"] > 1], *PARAMETERS)
    need(waves and longer, "one-wave solution and longer series")
    return [Ensemble(describe(group[0]), [(group[0], waves[0])]) for group in longer]


@claim(
    _with_one_wave,
    "The bounds from Westergaard's solution for the first wave are so loose as to include the predictions of all "
    "three methods (5).",
)
def one_wave_bounds(case: Case, wave: Case) -> Iterator[Number]:
    h = curve(wave, "westergaard")
    # Each estimate lies within h_1 and h_1 + 2 G_1 by construction: a finer wave adds between 0 and g_n to h_1.
    tail = float(tail_amplitude(1, float(case["D"]), float(case["gamma"])))
    spread = np.ptp([curve(case, method) for method in ESTIMATES], axis=0).max()
    what = "largest difference between estimates of the compliance over the width 2 G_1 of the bounds"
    yield Number(what, "%", spread / (2 * tail), "at most", 1 + ROUNDING, factor=1)
    low, high = resistance_bounds(case["mean_pressure"], h, tail, 0.0)
    R = np.array([curve(case, method, "resistance") for method in ESTIMATES])
    outside = np.maximum(low / np.maximum(R, ROUNDING), R / high).max()
    what = "largest ratio of a resistance to its upper bound, or of its lower bound to it"
    yield Number(what, "%", outside, "at most", 1 + ROUNDING, factor=1)


CLAIMS = {name: found for name, found in dict(globals()).items() if isinstance(found, Claim)}
