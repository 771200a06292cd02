"""The claims of the paper: for each one its words, and beside them the function that measures it.

"The numerical curve" of a case is that of the most accurate method that solved it. An excess or error is of an
estimate over the numerical curve. Averages are over the load, which is the axis of the paper's figures, and ranges of
loads end at interpolated compliances, so that no number depends on how the loads are spaced.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from weier.kernels.arrays import Array
from weier.pipeline import curves
from weier.pipeline.claims.claim import Cases, Measured, claim
from weier.pipeline.claims.ensemble import (
    MIN_MEMBERS,
    MIN_SHARE,
    OPEN_FACTOR,
    Condition,
    Ensemble,
    Kind,
    Limits,
    at_least,
    at_most,
    combine,
    ensembles,
    examine,
    judge,
    negative,
    positive,
    series,
)
from weier.pipeline.claims.readings import (
    LOW_COMPLIANCE,
    ROUNDING,
    MissingError,
    between_compliances,
    curve,
    describe,
    label,
    largest_size,
    loads_of,
    mean_over_loads,
    need,
    numerical,
    partial_contact,
    total_of,
)
from weier.theory.bounds import compliance_bounds, resistance_bounds
from weier.theory.series import tail_amplitude

if TYPE_CHECKING:
    import xarray as xr

ESTIMATES = ("archard", "demelio", "layer")  # the three approximations of Section 4

# What the paper's words are taken to mean.
CLOSE_AGREEMENT = 0.1  # relative to the compliance itself: no plot shows such an error at light loads
CLOSE = 0.05  # "fairly close", "good results", "relatively small": of the compliance at full contact
EXTREMELY_SMALL = 0.02  # of the compliance at full contact
MAX_ALIGNED_ANGLE = np.pi / 6  # "close to zero and pi": no farther from them than this
# Resistances are compared in this range of compliance over that at full contact. Below it one contact carries
# everything, and above it the resistance vanishes, so that no ratio has a meaning.
INTERMEDIATE = (0.1, 0.9)
DEMELIO_ERROR = 0.30  # of the resistance, in the paper: "by as much as"
LAYER_ERROR = 0.12  # of the resistance, in the paper: "about"
QUOTED_TOLERANCE = 1.25  # "as much as 30%" and "about 12%" allow up to this times the number
NUMERICAL_ERROR = 1e-3  # g_0, of the boundary elements: a smaller difference has no sign
RESISTANCE_ERROR = 0.01  # relative, of the numerical resistance: likewise
EXACT = at_most(1 + ROUNDING, factor=1)  # for ratios that a theorem allows up to 1
NONE = at_most(ROUNDING, factor=1)  # for distances that it allows none of

CRITERIA = (
    "Excess and error are of an estimate over the numerical curve. "
    f"Loads are low up to {LOW_COMPLIANCE:.0%} of the compliance at full contact, and high above. "
    f"Close means within {CLOSE:.0%} of the compliance at full contact, and extremely small within "
    f"{EXTREMELY_SMALL:.0%}; the few elements agree closely within {CLOSE_AGREEMENT:.0%} of the compliance itself. "
    f"Resistances are compared between {INTERMEDIATE[0]:.0%} and {INTERMEDIATE[1]:.0%} of the compliance at full "
    "contact: below, one contact carries everything, and above, the resistance vanishes, so that no ratio has a "
    "meaning. Averages are over the load.\n\n"
    "Each statement is judged on an ensemble of profiles that differ in their phases alone. A statement about all "
    "loads or profiles holds if every profile meets it, and does not hold if one contradicts it. A statement of what "
    f"tends to be holds if at least {MIN_SHARE:.0%} of the profiles meet it, and does not hold if as many contradict "
    f"it. Otherwise it is not decided. A profile leaves it open where the value is within {NUMERICAL_ERROR:g} g_0 "
    f"(or {RESISTANCE_ERROR:.0%} of the resistance) of a change of sign, lies between one of the limits above and "
    f"{OPEN_FACTOR:g} times this limit, or is closer to the limit than it moves where every second load is left out. "
    f"Fewer than {MIN_MEMBERS} profiles confirm nothing."
)


@claim(
    "Even with as few as 12 elements, the results agree closely with Eq. (12), except at very light loads where "
    "only one element is in contact (5.1).",
    "largest relative error of the compliance with more than one element in contact",
)
def twelve_elements(cases: Cases) -> Measured:
    """The relative error of a few elements against Eq. (12), with one in contact and with more."""
    error, close = "relative error of the compliance with", CLOSE_AGREEMENT
    conditions = [
        Condition(
            "few elements agree closely with Eq. (12) where more than one is in contact",
            f"largest {error} more than one element in contact",
            lambda case: largest_size(_errors_of_elements(case)[1]), at_most(close), form=".1%",
        ),
        Condition(
            "they do not agree closely where only one is in contact",
            f"largest {error} only one element in contact",
            lambda case: largest_size(_errors_of_elements(case)[0]), at_least(close), form=".1%",
        ),
    ]  # fmt: skip
    return judge(conditions, ensembles(cases))


def _errors_of_elements(case: xr.Dataset) -> tuple[Array, Array]:
    """The relative errors of boundary elements on one wave, with one element in contact and with more."""
    h, exact, fraction = curve(case, "bem"), curve(case, "westergaard"), curve(case, "bem", "contact_fraction")
    points = float(case["points"].values[case["solution_method"].values.tolist().index("bem")])
    single = points * fraction < 1.5
    need(single.any() and not single.all(), "loads with one element in contact and loads with more")
    error = h / exact - 1
    return error[single], error[~single]


@claim(
    "The curves for gamma = 2 lie fairly close to their average for all phases except those close to zero and "
    "pi; the effect of phase is extremely small at gamma = 5 (5.2).",
    "largest distance from the average at other phases for the smaller gamma, of the compliance at full contact",
)
def phase_spread(cases: Cases) -> Measured:
    """How far the curves of different phases lie from each other and from their average, for two gamma.

    The phases are the subject here, so that all of them together are one member.
    """
    groups = sorted(curves.groups(cases, "gamma"), key=lambda group: float(group[0]["gamma"]))
    need(len(groups) > 1, "phases for two values of gamma")
    ends = {f"gamma = {float(group[0]['gamma']):g}": group for group in (groups[0], groups[-1])}
    coarse, fine = (Ensemble(name, (group,), True) for name, group in ends.items())
    between = Condition(
        "the curves lie fairly close to their average at phases that are neither near zero nor near pi",
        "largest distance from the average at other phases, of full contact",
        lambda *phases: _distance_from_average(phases, aligned=False), at_most(CLOSE), form=".1%",
    )  # fmt: skip
    aligned = Condition(
        "phases close to zero and pi are an exception",
        "largest distance from the average at phases close to zero and pi, of full contact",
        lambda *phases: _distance_from_average(phases, aligned=True), at_least(CLOSE), form=".1%",
    )  # fmt: skip
    spread = Condition(
        "the effect of the phase is extremely small",
        "largest spread of all curves, of full contact",
        lambda *phases: float(np.ptp(_relative_curves(phases), axis=0).max()), at_most(EXTREMELY_SMALL), form=".1%",
    )  # fmt: skip
    return combine([[examine(between, coarse)], [examine(aligned, coarse)], [examine(spread, fine)]])


def _relative_curves(cases: Cases) -> Array:
    """The curves of some phases, shape (phases, loads), relative to the compliance at full contact."""
    return np.array([numerical(case) / total_of(case) for case in cases])


def _distance_from_average(cases: Cases, aligned: bool) -> float:
    """The largest distance of a curve from the average of all, among phases close to zero and pi or among others."""
    h, angle = _relative_curves(cases), np.array([curves.phase_angle(case) for case in cases])
    close = np.minimum(angle, np.pi - angle) <= MAX_ALIGNED_ANGLE + ROUNDING
    need(close.any() and not close.all(), "phases close to zero or pi and phases between")
    return largest_size((h - h.mean(axis=0))[close if aligned else ~close])


@claim(
    "The Archard approximation overestimates the compliance at all values of load (5.3).",
    "least excess of the compliance in partial contact, in g_0",
)
def archard_above(cases: Cases) -> Measured:
    """Archard's compliance less the numerical one, in partial contact."""
    condition = Condition(
        "Archard's compliance is too high at all loads",
        "least excess of Archard's compliance in partial contact, in g_0",
        lambda case: float(_excess(case, "archard")[partial_contact(case)].min()),
        at_least(-NUMERICAL_ERROR, factor=1),  # it may meet the numerical curve, as at full contact
    )
    return judge([condition], ensembles(cases))


def _excess(case: xr.Dataset, method: str) -> Array:
    """The compliance by an estimate less the numerical one, in g_0, shape (loads,)."""
    return curve(case, method) - numerical(case)


@claim(
    "The Demelio approximation underestimates the compliance at low loads (5.3).",
    "largest excess of the compliance at low loads, in g_0",
)
def demelio_below(cases: Cases) -> Measured:
    """Demelio's compliance less the numerical one, at low loads."""
    condition = Condition(
        "Demelio's compliance is too low at low loads",
        "largest excess of Demelio's compliance at low loads, in g_0",
        lambda case: float(_at_low_loads(case, _excess(case, "demelio")).max()),
        negative(NUMERICAL_ERROR),
    )
    return judge([condition], ensembles(cases))


def _at_low_loads(case: xr.Dataset, values: Array) -> Array:
    return between_compliances(case, values, 0, LOW_COMPLIANCE)[1]


@claim(
    "The non-linear layer model gives good results at low loads, but tends to underestimate the compliance "
    "slightly at high loads (5.3).",
    "mean excess of the compliance at high loads, in g_0",
)
def layer_close(cases: Cases) -> Measured:
    """The layer's compliance less the numerical one, at low and at high loads."""
    conditions = [
        Condition(
            "the layer underestimates the compliance at high loads",
            "mean excess of the layer's compliance at high loads, in g_0",
            lambda case: mean_over_loads(*between_compliances(case, _excess(case, "layer"), LOW_COMPLIANCE, 1)),
            negative(NUMERICAL_ERROR), Kind.most,
        ),
        Condition(
            "the layer gives good results at low loads",
            "its largest error at low loads, of full contact",
            lambda case: largest_size(_at_low_loads(case, _excess(case, "layer"))) / total_of(case),
            at_most(CLOSE), Kind.most, ".1%",
        ),
    ]  # fmt: skip
    return judge(conditions, ensembles(cases))


@claim(
    "The higher fractal dimension generally makes the approximations less accurate (5.3).",
    "growth of the largest error of the compliance by the estimate whose error grows least, of full contact",
)
def errors_grow_with_dimension(cases: Cases) -> Measured:
    """The largest error of each estimate, of the compliance at full contact, for the least and the largest D."""
    groups = series(cases, "D")
    findings = [[examine(_growth(method), each) for each in groups] for method in ESTIMATES]
    return combine(sorted(findings, key=lambda row: min(float(finding.values.mean()) for finding in row)))


def _growth(method: str) -> Condition:
    return Condition(
        f"the largest error of {label(method)} grows with D",
        f"growth of the largest error of {label(method)}, of full contact",
        lambda *cases: _largest_error(cases[-1], method) - _largest_error(cases[0], method),
        positive(NUMERICAL_ERROR), Kind.most, "+.2%",
    )  # fmt: skip


def _largest_error(case: xr.Dataset, method: str) -> float:
    return largest_size(_excess(case, method)) / total_of(case)


@claim(
    "The Archard approximation tends to underestimate the resistance, particularly at high loads; the Demelio "
    "approximation consistently overestimates it, by as much as 30%; the non-linear layer is best, its largest "
    "error an overestimate of about 12% at intermediate loads (5.4).",
    "largest relative error of the resistance by the non-linear layer",
    paper_value=LAYER_ERROR,
)
def resistance_errors(cases: Cases) -> Measured:
    """The relative errors of each estimate of the resistance, at intermediate compliance."""
    exactly = negative(RESISTANCE_ERROR)
    conditions = [
        Condition(
            f"the layer's largest error is about {LAYER_ERROR:.0%}",
            "largest relative error of the layer's resistance",
            lambda case: largest_size(_resistance_error(case, "layer")[1]), _up_to(LAYER_ERROR), form=".0%",
        ),
        Condition(
            "the layer's largest error is an overestimate",
            "its largest overestimate less its largest underestimate",
            lambda case: float(np.sum(_range(_resistance_error(case, "layer")[1]))), positive(RESISTANCE_ERROR),
            Kind.most, "+.0%",
        ),
        Condition(
            "the layer is the best estimate of the resistance",
            "its root mean square error less that of the better of the others",
            _layer_behind_others, exactly, Kind.most, "+.1%",
        ),
        Condition(
            "Archard underestimates the resistance at high loads",
            "mean relative error of Archard's resistance at high loads",
            lambda case: mean_over_loads(*_resistance_error(case, "archard", LOW_COMPLIANCE)), exactly, Kind.most,
            "+.0%",
        ),
        Condition(
            "Demelio overestimates the resistance at all loads",
            "least relative error of Demelio's resistance",
            lambda case: float(_resistance_error(case, "demelio")[1].min()),
            at_least(-RESISTANCE_ERROR, factor=1), form="+.0%",
        ),
        Condition(
            f"Demelio's errors are at most about {DEMELIO_ERROR:.0%}",
            "largest relative error of Demelio's resistance",
            lambda case: float(_resistance_error(case, "demelio")[1].max()), _up_to(DEMELIO_ERROR), form="+.0%",
        ),
    ]  # fmt: skip
    return judge(conditions, ensembles(cases))


def _up_to(quoted: float) -> Limits:
    """For values up to about a number of the paper."""
    return at_most(QUOTED_TOLERANCE * quoted)


def _range(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _resistance_error(case: xr.Dataset, method: str, lowest: float = INTERMEDIATE[0]) -> tuple[Array, Array]:
    """Loads of intermediate compliance, and the relative errors of the resistance by an estimate there."""
    exact = numerical(case, "resistance")
    with np.errstate(divide="ignore", invalid="ignore"):  # in full contact, which is no intermediate compliance
        error = curve(case, method, "resistance") / exact - 1
    return between_compliances(case, error, lowest, INTERMEDIATE[1])


def _layer_behind_others(case: xr.Dataset) -> float:
    squares = {method: _resistance_error(case, method) for method in ESTIMATES}
    size = {method: np.sqrt(mean_over_loads(loads, error**2)) for method, (loads, error) in squares.items()}
    return float(size["layer"] - min(size["archard"], size["demelio"]))


@claim(
    "The numerical resistance is rather sensitive to discretization errors (5.4).",
    "ratio of the largest relative errors of resistance and compliance",
)
def boundary_elements(cases: Cases) -> Measured:
    """The error of the boundary elements themselves, against the exact contact edges of the patches."""
    condition = Condition(
        "the resistance by boundary elements is more in error than the compliance",
        "ratio of the largest relative errors of resistance and compliance by boundary elements",
        lambda case: _resistance_discretisation(case) / _compliance_discretisation(case), at_least(1), form=".2g",
    )  # fmt: skip
    return judge([condition], ensembles(cases))


def _compliance_discretisation(case: xr.Dataset) -> float:
    """The largest error of the compliance by boundary elements, of that at full contact."""
    return largest_size(curve(case, "bem") - curve(case, "patches")) / total_of(case)


def _resistance_discretisation(case: xr.Dataset) -> float:
    """The largest relative error of the resistance by boundary elements, in partial contact."""
    resistance, exact = (curve(case, method, "resistance")[partial_contact(case)] for method in ("bem", "patches"))
    return largest_size(resistance / exact - 1)


@claim(
    "Additional fine scale features have a relatively small effect (5.5).",
    "largest change of the mean gap with the last term, of the compliance at full contact",
)
def fourth_term(cases: Cases) -> Measured:
    """How much each further term moves the mean gap."""
    conditions = [
        Condition(
            "the last term has a relatively small effect",
            "largest change of the mean gap with the last term, of full contact",
            lambda *lengths: _change(*lengths[-2:]) / total_of(lengths[-1]), at_most(CLOSE), form=".1%",
        ),
        Condition(
            "the last term has less effect than those before it",
            "this change over the least of those before",
            lambda *lengths: _change(*lengths[-2:]) / min(map(_change, lengths[:-2], lengths[1:-1]), default=np.inf),
            at_most(1), form=".2g",
        ),
    ]  # fmt: skip
    return judge(conditions, series(cases, "m"))


def _change(shorter: xr.Dataset, longer: xr.Dataset) -> float:
    """The largest change of the mean gap between two series, in g_0."""
    gaps = [total_of(case) - numerical(case) for case in (shorter, longer)]
    return largest_size(gaps[1] - gaps[0])


@claim(
    "The bounds from Westergaard's solution for the first wave are so loose as to include the predictions of all "
    "three methods (5).",
    "largest distance of an estimate from the one-wave solution, of G_1",
)
def one_wave_bounds(cases: Cases) -> Measured:
    """Where the estimates lie between the bounds that the one-wave solution gives for the infinite series.

    Notes
    -----
    Counted from the mean plane, the infinite series lies within G_1 of the one-wave solution. A series of m terms,
    such as the estimates here are of, lies within g_1 + ... + g_(m-1) < G_1. The estimates know no phases, so that
    one case of each series is enough.
    """
    one = next((case for case in cases if float(case["m"]) == 1), None)
    longer = curves.groups([case for case in cases if float(case["m"]) > 1], "D", "gamma", "m")
    if one is None or not longer:
        raise MissingError("there are no one-wave solution and longer series")
    exact = "westergaard" if curves.curve(one, "compliance", "westergaard") is not None else None
    groups = [Ensemble(describe(group[0]), ((group[0], one),), True) for group in longer]
    conditions = [
        Condition(
            "all compliances lie within the bounds",
            "largest distance from the one-wave solution, of G_1",
            lambda case, wave: _distance_of_compliances(case, _wave(wave, exact)), EXACT, form=".0%",
        ),
        Condition(
            "all resistances lie within the bounds",
            "largest distance of a resistance beyond its bounds, in g_0/p_0*",
            lambda case, wave: _excess_of_resistances(case, _wave(wave, exact)), NONE, form=".2g",
        ),
    ]  # fmt: skip
    return judge(conditions, groups)


def _wave(case: xr.Dataset, method: str | None) -> Array:
    """The compliance of one wave, by the closed form if there is one."""
    return numerical(case) if method is None else curve(case, method)


def _tail_of_one(case: xr.Dataset) -> float:
    return float(tail_amplitude(1, float(case["D"]), float(case["gamma"])))


def _distance_of_compliances(case: xr.Dataset, wave: Array) -> float:
    tail = _tail_of_one(case)
    lower, upper = compliance_bounds(wave - 1, tail)
    estimates = (curve(case, method) - total_of(case) for method in ESTIMATES)
    return max(largest_size(2 * h - lower - upper) for h in estimates) / (2 * tail)


def _excess_of_resistances(case: xr.Dataset, wave: Array) -> float:
    low, high = resistance_bounds(loads_of(case), wave, _tail_of_one(case), 0.0)
    estimates = [curve(case, method, "resistance") for method in ESTIMATES]
    return float(max(max((low - each).max(), (each - high).max()) for each in estimates))
