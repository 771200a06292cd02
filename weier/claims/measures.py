"""What a claim of the paper comes to on the cases of a scene: one small function a claim.

The numerical curve is that of the most accurate method a case has.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier import curves
from weier.bounds import compliance_bounds, resistance_bounds
from weier.profile import tail_amplitude

Array = NDArray[np.float64]
Cases = Sequence[xr.Dataset]

# What the paper's words are taken to mean.
AGREE_CLOSELY = 0.1  # relative to the compliance itself, which no plot shows at light loads
CLOSE = 0.05  # "fairly close", "good results", "relatively small": of the compliance at full contact
EXTREMELY_SMALL = 0.02  # of the compliance at full contact
ALIGNED = np.pi / 6  # "close to zero and pi": no farther from them than this
HALF = 0.5  # of the compliance at full contact: low loads lie below, high loads above
# Of it. Below, one contact carries all; above, the resistance vanishes: no ratio has a meaning.
INTERMEDIATE = (0.1, 0.9)
ABOUT = 1.25  # "as much as 30%", "about 12%": up to this times that
NOISE = 1e-3  # g_0: the error of the boundary elements; a smaller difference has no sign
ROUNDING = 1e-9
MOST_CASES = 4  # that a text names one by one

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


class MissingError(ValueError):
    """The studies lack what a claim is about."""


def few_elements(cases: Cases) -> Measured:
    """A few elements against Eq. (12): the relative error with one in contact, and with more."""
    (case, *_) = cases
    h, exact, fraction = _curve(case, "bem"), _curve(case, "westergaard"), _curve(case, "bem", "contact_fraction")
    points = float(case["points"].values[case["method"].values.tolist().index("bem")])
    single = points * fraction < 1.5
    _need(single.any() and not single.all(), "loads with one element in contact and loads with more")
    error = h / exact - 1
    one, more = _extreme(error[single]), _extreme(error[~single])
    text = (
        f"{points:.0f} elements: error of at most {more:+.1%} with more than one element in contact, "
        f"of {one:+.1%} with one (up to {_loads(case)[single].max():.2g} p_0*)."
    )
    return Measured(text, abs(more), bool(abs(more) < AGREE_CLOSELY < abs(one)))


def boundary_elements(cases: Cases) -> Measured:
    """The error of the boundary elements themselves, against the exact contact edges."""
    texts, ratios = [], []
    for case in cases:
        partial = _partial(case)
        miss = np.abs(_curve(case, "bem") - _curve(case, "patches")).max()
        R, exact = (_curve(case, method, "resistance")[partial] for method in ("bem", "patches"))
        off = np.abs(R / exact - 1)
        texts.append(
            f"{_name(case)}: compliance within {miss:.1g} g_0, resistance within {np.median(off):.2%} for half of "
            f"the loads and {off.max():.0%} for all"
        )
        ratios.append(float(off.max() / (miss / case["total_amplitude"])))
    return Measured(_listed(texts), min(ratios), min(ratios) > 1)


def phase_spread(cases: Cases) -> Measured:
    """How far the curves of different phases lie from each other and from their average, for two gamma."""
    groups = sorted(curves.groups(cases, "gamma"), key=lambda group: float(group[0]["gamma"]))
    _need(len(groups) > 1, "phases for two values of gamma")
    (coarse, first), (fine, second) = (_phases(group) for group in (groups[0], groups[-1]))
    holds = coarse["others"] < CLOSE < coarse["aligned"] and fine["spread"] < EXTREMELY_SMALL
    return Measured(f"{first} {second}", fine["spread"], holds)


def _phases(cases: Cases) -> tuple[dict[str, float], str]:
    """Spread, and distances of aligned and of other phases from the average, of the compliance at full contact."""
    h, loads = np.array([_numerical(case) for case in cases]), _loads(cases[0])
    total = float(cases[0]["total_amplitude"])
    spread, off = np.ptp(h, axis=0) / total, np.abs(h - h.mean(axis=0)).max(axis=1) / total
    angle = np.array([curves.phase_angle(case) for case in cases])
    aligned = np.minimum(angle, np.pi - angle) <= ALIGNED + ROUNDING
    _need(aligned.any() and not aligned.all(), "phases close to zero or pi and phases between")
    widest, heavy = int(spread.argmax()), loads >= INTERMEDIATE[0]
    farthest = angle[off.argmax()] / np.pi
    text = (
        f"gamma = {float(cases[0]['gamma']):g}: the curves spread over up to {total * spread[widest]:.2g} g_0, "
        f"{spread[widest]:.1%} of full contact, at {loads[widest]:.2g} p_0*"
        + (f" ({total * spread[heavy].max():.2g} g_0 from {INTERMEDIATE[0]:g} p_0* on)" if heavy.any() else "")
        + f"; the phase farthest from their average is {farthest:.2g} pi, by {total * off.max():.2g} g_0, "
        f"and those not close to zero and pi stay within {total * off[~aligned].max():.2g} g_0."
    )
    values = {"spread": spread.max(), "aligned": off[aligned].max(), "others": off[~aligned].max()}
    return {name: float(value) for name, value in values.items()}, text


def archard_above(cases: Cases) -> Measured:
    """Archard's compliance less the numerical one, in partial contact."""
    excess = {_name(case): (_curve(case, "archard") - _numerical(case))[_partial(case)] for case in cases}
    text = _listed(f"{name}: {_span(values)} g_0 in partial contact" for name, values in excess.items())
    least = min(values.min() for values in excess.values())
    return Measured(text, float(least), bool(least > -NOISE))


def demelio_below(cases: Cases) -> Measured:
    """Demelio's compliance less the numerical one at low loads, and from where on it is above."""
    texts, highest = [], []
    for case in cases:
        low, _ = _low_and_high(case)
        excess = _curve(case, "demelio") - _numerical(case)
        above = _loads(case)[excess > NOISE]
        sign = f"above from {above.min():.2g} p_0* on" if above.size else "nowhere above"
        texts.append(f"{_name(case)}: {_span(excess[low])} g_0 at low loads, {sign}")
        highest.append(float(excess[low].max()))
    return Measured(_listed(texts), max(highest), max(highest) < 0)


def layer_close(cases: Cases) -> Measured:
    """The layer's compliance less the numerical one, at low and at high loads."""
    texts, worst, means = [], [], []
    for case in cases:
        low, high = _low_and_high(case)
        excess = _curve(case, "layer") - _numerical(case)
        worst.append(float(np.abs(excess[low]).max() / case["total_amplitude"]))
        means.append(float(excess[high].mean()))
        texts.append(
            f"{_name(case)}: {_span(excess[low])} g_0 at low loads ({worst[-1]:.1%} of full contact), "
            f"{_span(excess[high])} g_0 at high loads with a mean of {means[-1]:+.1g} g_0"
        )
    return Measured(_listed(texts), max(worst), max(worst) < CLOSE and max(means) < 0)


def errors_grow_with_dimension(cases: Cases) -> Measured:
    """The largest error of each estimate, of the compliance at full contact, for the least and the largest D."""
    ordered = sorted(cases, key=lambda case: float(case["D"]))
    _need(ordered and ordered[0]["D"] < ordered[-1]["D"], "cases of two values of D")
    ends = ordered[0], ordered[-1]
    errors = {
        method: [
            float(np.abs(_curve(case, method) - _numerical(case)).max() / case["total_amplitude"]) for case in ends
        ]
        for method in curves.ESTIMATES
    }
    shown = ", ".join(f"{method} {less:.1%} and {more:.1%}" for method, (less, more) in errors.items())
    text = f"Largest error of full contact for D = {float(ends[0]['D']):g} and {float(ends[1]['D']):g}: {shown}."
    growth = min(more / less for less, more in errors.values())
    return Measured(text, growth, growth > 1)


def resistance_errors(cases: Cases) -> Measured:
    """Extremes of the relative error of each estimate of the resistance, at intermediate compliance."""
    texts, holds, worst = [], [], []
    for case in cases:
        loads, errors = _resistance_errors(case)
        high = loads >= np.median(loads)
        texts.append(
            f"{_name(case)}: " + ", ".join(f"{m} {_percent(e)} (mean {e.mean():+.0%})" for m, e in errors.items())
            + f" from {loads[0]:.2g} to {loads[-1]:.2g} p_0*"
        )  # fmt: skip
        size = {method: float(np.sqrt(np.mean(error**2))) for method, error in errors.items()}
        worst.append(float(np.abs(errors["layer"]).max()))
        holds.append(
            errors["archard"][high].mean() < 0
            and errors["demelio"].min() > -CLOSE
            and errors["demelio"].max() < ABOUT * 0.30
            and min(size, key=size.__getitem__) == "layer"
            and worst[-1] < ABOUT * 0.12
        )
    return Measured(_listed(texts), max(worst), bool(all(holds)))


def _resistance_errors(case: xr.Dataset) -> tuple[Array, dict[str, Array]]:
    part = _numerical(case) / float(case["total_amplitude"])
    seen = (part >= INTERMEDIATE[0]) & (part <= INTERMEDIATE[1])
    _need(seen.any(), "loads of intermediate compliance")
    exact = _numerical(case, "resistance")[seen]
    return _loads(case)[seen], {m: _curve(case, m, "resistance")[seen] / exact - 1 for m in curves.ESTIMATES}


def last_term(cases: Cases) -> Measured:
    """How much each further term moves the mean gap, and what the bounds theorem allows the last."""
    ordered = sorted(cases, key=lambda case: float(case["m"]))
    _need(len(ordered) > 1, "series of two lengths")
    gap = [float(case["total_amplitude"]) - _numerical(case) for case in ordered]
    moved = [float(np.abs(more - less).max()) for less, more in pairwise(gap)]
    last, before = ordered[-1], ordered[-2]
    part = moved[-1] / float(last["total_amplitude"])
    allowed = float(last["total_amplitude"] - before["total_amplitude"])
    steps = ", ".join(f"{v:.2g} g_0 from m = {float(c['m']):g}" for v, c in zip(moved, ordered, strict=False))
    text = (
        f"One more term moves the mean gap by up to {steps}; the last step is {part:.1%} of full contact, and the "
        f"bounds theorem allows it {allowed:.2g} g_0."
    )
    return Measured(text, part, part < CLOSE and moved[-1] == min(moved))


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
    wave = (
        _curve(one, "westergaard") if curves.curve(one, "compliance", "westergaard") is not None else _numerical(one)
    )
    texts, used, inside = [], [], []
    for case in longer:
        places, within = _places(case, wave)
        used += list(places.values())
        inside.append(within)
        shown = ", ".join(f"{method} {place:.0%}" for method, place in places.items())
        texts.append(
            f"{_name(case)}: farthest from the one-wave solution, of G_1, are {shown}; the resistances "
            f"lie {'within' if within else 'not all within'} its bounds"
        )
    return Measured(_listed(texts), max(used), max(used) <= 1 + ROUNDING and all(inside))


def _places(case: xr.Dataset, wave: Array) -> tuple[dict[str, float], bool]:
    """Each estimate's distance from the middle of the bounds over their half-width; resistances inside or not."""
    tail = float(tail_amplitude(1, float(case["D"]), float(case["gamma"])))
    lower, upper = compliance_bounds(wave - 1, tail)
    low, high = resistance_bounds(_loads(case), wave, tail, 0.0)
    places, within = {}, True
    for method in curves.ESTIMATES:
        h, resistance = _curve(case, method) - float(case["total_amplitude"]), _curve(case, method, "resistance")
        places[method] = float(np.abs(2 * h - lower - upper).max() / (2 * tail))
        within &= bool(np.all((resistance >= low - ROUNDING) & (resistance <= high + ROUNDING)))
    return places, within


def _need(there: object, what: str) -> None:
    if not there:
        raise MissingError(f"there are no {what}")


def _curve(case: xr.Dataset, method: str, name: str = "compliance") -> Array:
    values = curves.curve(case, name, method)
    if values is None:
        raise MissingError(f"{_name(case)} has no {name} by {method}")
    return values


def _numerical(case: xr.Dataset, name: str = "compliance") -> Array:
    values = curves.numerical(case, name)
    if values is None:
        raise MissingError(f"{_name(case)} has no numerical solution")
    return values


def _loads(case: xr.Dataset) -> Array:
    loads: Array = case["mean_pressure"].values
    return loads


def _partial(case: xr.Dataset) -> NDArray[np.bool_]:
    partial: NDArray[np.bool_] = _numerical(case, "contact_fraction") < 1 - ROUNDING
    _need(partial.any(), "loads of partial contact")
    return partial


def _low_and_high(case: xr.Dataset) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The loads on either side of half the compliance at full contact; in full contact all methods agree."""
    low = _numerical(case) <= HALF * float(case["total_amplitude"])
    high = ~low & _partial(case)
    _need(low.any() and high.any(), "loads on both sides of half the compliance at full contact")
    return low, high


def _extreme(values: Array) -> float:
    return float(values[np.abs(values).argmax()])


def _name(case: xr.Dataset) -> str:
    return curves.profile(case).describe()


def _span(values: Array) -> str:
    return f"{values.min():+.2g} to {values.max():+.2g}"


def _percent(values: Array) -> str:
    return f"{values.min():+.0%} to {values.max():+.0%}"


def _listed(texts: Iterable[str]) -> str:
    texts = list(texts)
    more = len(texts) - MOST_CASES
    return "; ".join(texts[:MOST_CASES]) + (f"; and {more} more cases." if more > 0 else ".")
