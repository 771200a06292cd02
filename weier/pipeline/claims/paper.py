"""The claims of the paper: each statement, and its interpretation as conditions."""

from __future__ import annotations

from functools import partial

import numpy as np

from weier.data import curves
from weier.methods.registry import find_method
from weier.pipeline.claims import measures
from weier.pipeline.claims.claim import (
    MIN_FRACTION,
    MIN_MEMBERS,
    OPEN_FACTOR,
    Case,
    Cases,
    Claim,
    Condition,
    Ensemble,
    at_least,
    at_most,
    negative,
    not_negative,
    positive,
)
from weier.pipeline.claims.measures import (
    ESTIMATES,
    INTERMEDIATE,
    LOW_COMPLIANCE,
    PARTIAL,
    ROUNDING,
    describe,
    need,
)
from weier.surface.profile import PARAMETERS

# Limits that quantify words of the paper.
CLOSE_AGREEMENT = 0.1  # Relative errors below this are not visible in a plot at light loads.
CLOSE = 0.05  # quantifies "fairly close", "good results" and "relatively small", over full contact
EXTREMELY_SMALL = 0.02  # quantifies "extremely small", over full contact
DEMELIO_ERROR = 0.30  # relative error of the resistance in the paper: "by as much as"
LAYER_ERROR = 0.12  # relative error of the resistance in the paper: "about"
QUOTED_TOLERANCE = 1.25  # "As much as 30%" and "about 12%" allow up to this factor.
QUITE_GOOD = 0.1  # "Quite good" for h, over full contact; for R it means the 30 % given for Demelio.
PHASE_DIGITS = 11  # Phases that agree in these digits are equal.
LIGHT_LOAD = 0.01  # p_0*: as p -> 0, every estimate tends to 0, the exact compliance to its value at first contact
SAME_RATE = 1.1  # The area falls as gamma^(1-D) a term within this factor, which is within the scatter of phases.

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


def by_phases(cases: Cases) -> list[Ensemble]:
    """Return an ensemble for each D, gamma and m, with each case as a member; a single wave has one member."""
    need(cases, "cases")
    return [
        Ensemble(describe(group[0]), tuple((case,) for case in group), float(group[0]["m"]) == 1)
        for group in curves.groups(cases, *PARAMETERS)
    ]


def by_mean(cases: Cases) -> list[Ensemble]:
    """Return the mean of each ensemble, which decides, and its members for information."""
    single = by_phases(cases)
    means = [
        Ensemble(
            f"{own.name}, mean of {len(own.members)}",
            ((measures.ensemble_mean([case for (case,) in own.members]),),),
            own.complete or len(own.members) >= MIN_MEMBERS,
        )
        for own in single
    ]
    return means + [own._replace(name=f"{own.name}, one by one", decides=False) for own in single]


def series(cases: Cases, varied: str) -> list[Ensemble]:
    """Return members: cases of equal phases (of common terms), ordered by the one parameter that varies."""
    found = []
    for group in curves.groups(cases, *(name for name in PARAMETERS if name != varied)):
        rows = _rows(group, varied)
        members = tuple(row for row in rows if len(row) > 1)
        if members:
            first, last = members[0][0], members[0][-1]
            others = [f"{name} = {float(first[name]):g}" for name in PARAMETERS if name != varied]
            name = ", ".join([f"{varied} from {float(first[varied]):g} to {float(last[varied]):g}", *others])
            found.append(Ensemble(name, members))
    need(found, f"cases of the same phases and different {varied}")
    return found


def _rows(cases: Cases, varied: str) -> list[Cases]:
    """Return rows of cases, one case per value of a parameter, that share the phases of their common terms."""
    by_value: dict[float, list[tuple[tuple[float, ...], Case]]] = {}
    for case in cases:
        phases = case["phases"]
        own = tuple(phases[np.isfinite(phases)].round(PHASE_DIGITS).tolist())
        by_value.setdefault(float(case[varied]), []).append((own, case))
    values = sorted(by_value)
    terms = {value: len(by_value[value][0][0]) for value in values}
    last = terms[values[-1]]
    alike = {value: {own[:last]: case for own, case in by_value[value]} for value in values}
    rows: list[Cases] = []
    for own, _ in by_value[values[-1]]:
        found = (alike[value].get(own[: terms[value]]) for value in values)
        rows.append([case for case in found if case is not None])
    return rows


def _coarse_and_fine(cases: Cases) -> list[Ensemble]:
    """Return two ensembles, smallest and largest gamma, each with all phases as one member."""
    groups = sorted(curves.groups(cases, "gamma"), key=lambda group: float(group[0]["gamma"]))
    need(len(groups) > 1, "phases for two values of gamma")
    return [Ensemble(f"gamma = {float(group[0]['gamma']):g}", (group,), True) for group in (groups[0], groups[-1])]


COARSE, FINE = slice(0, 1), slice(1, 2)  # The ensembles of `_coarse_and_fine`.


def _with_one_wave(cases: Cases) -> list[Ensemble]:
    """Return one case of each longer series (the estimates are independent of phases) and the one-wave solution."""
    waves = [case for case in cases if float(case["m"]) == 1]
    longer = curves.groups([case for case in cases if float(case["m"]) > 1], *PARAMETERS)
    need(waves and longer, "one-wave solution and longer series")
    return [Ensemble(describe(group[0]), ((group[0], waves[0]),), True) for group in longer]


def _growth(method: str) -> Condition:
    label = find_method(method).label
    return Condition(
        f"growth of the largest error of {label}, of full contact",
        "%",
        partial(measures.growth_of_error, method),
        positive("compliance"),
        most=True,
    )


CLAIMS = {
    "twelve_elements": Claim(
        "Even with as few as 12 elements, the results agree closely with Eq. (12), except at very light loads where "
        "only one element is in contact (5.1).",
        by_phases,
        Condition(
            "largest relative error of the compliance with more than one element in contact",
            "%",
            lambda case: measures.errors_of_elements(case)[1],
            at_most(CLOSE_AGREEMENT),
        ),
        Condition(
            "largest relative error of the compliance with only one element in contact",
            "%",
            lambda case: measures.errors_of_elements(case)[0],
            at_least(CLOSE_AGREEMENT),
        ),
    ),
    "phase_spread": Claim(
        "The curves for gamma = 2 lie fairly close to their average for all phases except those close to zero and "
        "pi; the effect of phase is extremely small at gamma = 5 (5.2).",
        _coarse_and_fine,
        Condition(
            "largest distance from the average at other phases, of full contact",
            "%",
            lambda *phases: measures.distances_from_average(*phases)[1],
            at_most(CLOSE),
            ensembles=COARSE,
        ),
        Condition(
            "largest distance from the average at phases close to zero and pi, of full contact",
            "%",
            lambda *phases: measures.distances_from_average(*phases)[0],
            at_least(CLOSE),
            ensembles=COARSE,
        ),
        Condition(
            "largest spread of all curves, of full contact",
            "%",
            measures.spread_of_phases,
            at_most(EXTREMELY_SMALL),
            ensembles=FINE,
        ),
    ),
    "archard_above": Claim(
        "The Archard approximation overestimates the compliance at all values of load (5.3): at all but the "
        "lightest, where Archard's compliance tends to 0 and that of the surface to its value at first contact.",
        by_phases,
        Condition(
            "load above which Archard's compliance is too high",
            "p_0*",
            lambda case: measures.load_of_crossing(case, "archard"),
            at_most(LIGHT_LOAD),
        ),
        Condition(
            "least excess of Archard's compliance over that from first contact",
            "g_0",
            lambda case: measures.least_excess_from_first_contact(case, "archard"),
            not_negative("compliance"),
            decides=False,
        ),
    ),
    "demelio_below": Claim(
        "The Demelio approximation underestimates the compliance at low loads (5.3).",
        by_phases,
        Condition(
            "largest excess of Demelio's compliance at low loads",
            "g_0",
            lambda case: float(measures.excess_at_low_loads(case, "demelio").max()),
            negative("compliance"),
        ),
    ),
    "layer_close": Claim(
        "The non-linear layer model gives good results at low loads, but tends to underestimate the compliance "
        "slightly at high loads (5.3).",
        by_phases,
        Condition(
            "mean excess of the layer's compliance at high loads",
            "g_0",
            lambda case: measures.mean_excess_at_high_loads(case, "layer"),
            negative("compliance"),
            most=True,
        ),
        Condition(
            "largest error of the layer's compliance at low loads, of full contact",
            "%",
            lambda case: measures.error_at_low_loads(case, "layer"),
            at_most(CLOSE),
            most=True,
        ),
    ),
    "errors_grow_with_dimension": Claim(
        "The higher fractal dimension generally makes the approximations less accurate (5.3).",
        partial(series, varied="D"),
        *map(_growth, ESTIMATES),
    ),
    "resistance_errors": Claim(
        "The Archard approximation tends to underestimate the resistance, particularly at high loads; the Demelio "
        "approximation consistently overestimates it, by as much as 30%; the non-linear layer is best, its largest "
        "error an overestimate of about 12% at intermediate loads (5.4).",
        by_mean,
        Condition(
            "largest relative error of the layer's resistance",
            "%",
            lambda case: max(map(abs, measures.resistance_range(case, "layer"))),
            at_most(QUOTED_TOLERANCE * LAYER_ERROR),
        ),
        Condition(
            "largest overestimate of the layer's resistance less its largest underestimate",
            "%",
            lambda case: sum(measures.resistance_range(case, "layer")),
            positive("resistance"),
            most=True,
        ),
        Condition(
            "root mean square error of R by the layer minus the better of the other estimates",
            "%",
            measures.layer_behind_others,
            negative("resistance"),
            most=True,
        ),
        Condition(
            "root mean square error of R over ln p from the lightest load on, minus the better of the others",
            "%",
            partial(measures.layer_behind_others, lightest=True),
            negative("resistance"),
            most=True,
            decides=False,
        ),
        Condition(
            "mean relative error of Archard's resistance at high loads",
            "%",
            lambda case: measures.mean_resistance_error_at_high_loads(case, "archard"),
            negative("resistance"),
            most=True,
        ),
        Condition(
            "least relative error of Demelio's resistance",
            "%",
            lambda case: measures.resistance_range(case, "demelio")[0],
            not_negative("resistance"),
        ),
        Condition(
            "largest relative error of Demelio's resistance",
            "%",
            lambda case: measures.resistance_range(case, "demelio")[1],
            at_most(QUOTED_TOLERANCE * DEMELIO_ERROR),
        ),
    ),
    "resistance_falls": Claim(
        "All the curves show the typical reduction of contact resistance with increasing load (5.4).",
        by_phases,
        Condition(
            "largest rise of a resistance from one load to the next, over its largest value",
            "",
            measures.largest_rise_of_resistance,
            at_most(ROUNDING, factor=1),
        ),
    ),
    "bounds_looser": Claim(
        "The bounds on the resistance are less tight than those on the load-compliance relation (5.5).",
        by_phases,
        Condition(
            "relative width of the bounds on the resistance over that on the compliance",
            "",
            measures.width_of_bounds,
            at_least(1),
        ),
    ),
    "rises_further": Claim(
        "For D = 1.5 the curves continue to rise through larger values of the load (5.3).",
        partial(series, varied="D"),
        Condition(
            "load of 99 % of full contact for the largest D over that for the smallest",
            "",
            measures.later_full_contact,
            at_least(1),
        ),
    ),
    "approximations_good": Claim(
        "All the proposed approximations give quite good predictions of the curves (6).",
        by_mean,
        *(
            condition
            for method in ESTIMATES
            for condition in (
                Condition(
                    f"mean error of the compliance by {find_method(method).label}, of full contact",
                    "%",
                    partial(measures.mean_error, method=method),
                    at_most(QUITE_GOOD),
                ),
                Condition(
                    f"mean relative error of the resistance by {find_method(method).label}",
                    "%",
                    partial(measures.mean_resistance_error, method=method),
                    at_most(DEMELIO_ERROR),
                ),
            )
        ),
    ),
    "boundary_elements": Claim(
        "The numerical resistance is rather sensitive to discretization errors (5.4).",
        by_phases,
        Condition(
            "ratio of the largest relative errors of resistance and compliance by boundary elements",
            "",
            measures.discretisation_ratio,
            at_least(1),
        ),
    ),
    "fourth_term": Claim(
        "Additional fine scale features have a relatively small effect (5.5).",
        partial(series, varied="m"),
        Condition(
            "largest change of the mean gap with the last term, of full contact",
            "%",
            measures.last_change,
            at_most(CLOSE),
        ),
        Condition(
            "largest change of the mean gap with the last term over the least with those before",
            "",
            measures.last_change_over_others,
            at_most(1),
        ),
    ),
    "area_vanishes": Claim(
        "The contact area reduces without limit as finer and finer scales are added (1), while stiffness and "
        "resistance are largely determined by the coarse scales (5.5, 6).",
        partial(series, varied="m"),
        Condition(
            "largest ratio of the contact areas with one more term and without it",
            "",
            measures.growth_of_area,
            at_most(1, factor=1),
        ),
        Condition(
            "factor of the area with the last term over gamma^(1-D), mean over the loads",
            "",
            measures.decay_of_area,
            at_most(SAME_RATE),
            most=True,
        ),
        Condition(
            "mean absolute relative change of the resistance with the last term",
            "%",
            measures.mean_change_of_resistance,
            at_most(CLOSE),
            most=True,
        ),
        Condition(
            "largest relative change of the resistance with the last term",
            "%",
            measures.largest_change_of_resistance,
            at_most(CLOSE),
            decides=False,
        ),
    ),
    "independent_contacts": Claim(
        "Classical asperity models predict continued change in contact resistance as more fine scale features are "
        "added (6), since the number of independent contacts times their size grows without limit (2).",
        partial(series, varied="m"),
        Condition(
            "factor of the number of contacts with the last term, mean over the load",
            "",
            measures.growth_of_count,
            at_least(1),
        ),
        Condition(
            "factor of the resistance of independent contacts with the last term",
            "",
            measures.factor_of_independent_contacts,
            at_most(1 - DEMELIO_ERROR, factor=1),
        ),
    ),
    "one_wave_bounds": Claim(
        "The bounds from Westergaard's solution for the first wave are so loose as to include the predictions of all "
        "three methods (5).",
        _with_one_wave,
        Condition(
            "largest difference between estimates of the compliance over the width 2 G_1 of the bounds",
            "%",
            measures.spread_over_bounds,
            at_most(1 + ROUNDING, factor=1),
        ),
        Condition(
            "largest ratio of a resistance to its upper bound, or of its lower bound to it",
            "%",
            measures.resistance_over_bounds,
            at_most(1 + ROUNDING, factor=1),
        ),
    ),
}
