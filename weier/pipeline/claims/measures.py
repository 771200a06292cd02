"""Quantities of the claims, measured on the cases of a profile.

The numerical curve of a case is the solution by its most accurate method. Excess and error compare an estimate with
it. Averages are over the load, which is the axis of the paper's figures, and ranges of
loads end at interpolated compliances, so that no number depends on how the loads are spaced.
"""

from __future__ import annotations

import itertools

import numpy as np

from weier.data import curves
from weier.kernels.arrays import Array, Flags
from weier.methods.registry import find_method
from weier.pipeline.claims.claim import Case, Cases, MissingError
from weier.surface.series import full_contact_pressure, tail_amplitude
from weier.theory.bounds import resistance_bounds

ESTIMATES = ("archard", "demelio", "layer")  # the approximations of Section 4
LOW_COMPLIANCE = 0.5  # boundary between low and high loads, as a fraction of the compliance at full contact
# Ranges of compliance over that at full contact. Below both, one contact carries the load. Above the first one, the
# coarse waves are flat and the finest ones alone resist; above the second one, the resistance itself vanishes.
INTERMEDIATE = (0.1, 0.9)
PARTIAL = (0.1, curves.FULL_CONTACT_COMPLIANCE)
MAX_ALIGNED_ANGLE = np.pi / 6  # largest distance of phases "close to zero and pi"
ROUNDING = 1e-9  # allowance for rounding and iteration in numbers close to 1


def need(available: object, what: str) -> None:
    """Raise MissingError if the data of a claim are not available."""
    if not available:
        raise MissingError(f"there are no {what}")


def curve(case: Case, method: str | None, quantity: str = "compliance") -> Array:
    """Return the values of a quantity over the loads by one method; raises MissingError if the method has none."""
    values = curves.curve(case, quantity, method)
    if values is None:
        what = f"{quantity} by {find_method(method).label}" if method else "numerical solution"
        raise MissingError(f"{describe(case)} has no {what}")
    return values


def numerical(case: Case, quantity: str = "compliance") -> Array:
    """Return the values by the most accurate method that solved the case; raises MissingError if none did."""
    return curve(case, curves.numerical_method(case), quantity)


def describe(case: Case) -> str:
    """Return the profile of a case in words."""
    return curves.profile(case).describe()


def _total(case: Case) -> float:
    """Return the compliance at full contact, sum g_n, in g_0."""
    return float(case["total_amplitude"])


def _largest(values: Array) -> float:
    return float(np.abs(values).max())


def _partial_contact(case: Case) -> Flags:
    """Return whether the contact is partial at each load; raises MissingError if no load gives partial contact."""
    partial: Flags = numerical(case, "contact_fraction") < 1 - ROUNDING
    need(partial.any(), "loads of partial contact")
    return partial


def _between(case: Case, values: Array, low: float, high: float) -> tuple[Array, Array]:
    """Return loads and values where the numerical compliance lies in a range, relative to full contact.

    The ends of the range are interpolated, so that they do not depend on the spacing of the loads. A range up to
    full contact ends at the last load of partial contact, since all methods agree above. MissingError is raised if
    the loads do not reach across half of the range.
    """
    loads, relative, partial = case["mean_pressure"], numerical(case) / _total(case), _partial_contact(case)
    loads, relative, values = loads[partial], relative[partial], values[partial]
    middle = (low + high) / 2
    need(relative[0] < middle < relative[-1], f"loads across {middle:.0%} of the compliance at full contact")
    ends = np.interp([low, high], relative, loads)
    inside = (loads > ends[0]) & (loads < ends[1])
    within = np.concatenate([ends[:1], loads[inside], ends[1:]])
    return within, np.interp(within, loads, values)


def _mean(loads: Array, values: Array) -> float:
    """Return the mean of the values over the load, by the trapezoidal rule."""
    return float(np.trapezoid(values, loads) / (loads[-1] - loads[0]))


def errors_of_elements(case: Case) -> tuple[float, float]:
    """Return the largest relative errors of boundary elements on one wave: one node in contact, and several."""
    h, exact, fraction = curve(case, "bem"), curve(case, "westergaard"), curve(case, "bem", "contact_fraction")
    points = float(case["points"][case["solution_method"].tolist().index("bem")])
    single = points * fraction < 1.5
    need(single.any() and not single.all(), "loads with one element in contact and loads with more")
    return _largest((h / exact - 1)[single]), _largest((h / exact - 1)[~single])


def _relative_curves(phases: tuple[Case, ...]) -> Array:
    """Return the curves of some phases, shape (phases, loads), relative to the compliance at full contact."""
    return np.array([numerical(case) / _total(case) for case in phases])


def distances_from_average(*phases: Case) -> tuple[float, float]:
    """Return the largest distances of curves from their average, for phases near 0 and pi, and for others."""
    h, angle = _relative_curves(phases), np.array([curves.phase_angle(case) for case in phases])
    close = np.minimum(angle, np.pi - angle) <= MAX_ALIGNED_ANGLE + ROUNDING
    need(close.any() and not close.all(), "phases close to zero or pi and phases between")
    distance = h - h.mean(axis=0)
    return _largest(distance[close]), _largest(distance[~close])


def spread_of_phases(*phases: Case) -> float:
    """Return the largest distance between the curves of two phases."""
    return float(np.ptp(_relative_curves(phases), axis=0).max())


def excess(case: Case, method: str) -> Array:
    """Return the compliance by an estimate less the numerical one, in g_0, shape (loads,)."""
    return curve(case, method) - numerical(case)


def least_excess_from_first_contact(case: Case, method: str) -> float:
    """Return the least excess in partial contact over the numerical compliance counted from first contact."""
    return float((excess(case, method) + float(case["first_contact"]))[_partial_contact(case)].min())


def load_of_crossing(case: Case, method: str) -> float:
    """Return the load above which an estimate of the compliance is too high, in p_0*; the first one if it always is.

    Close to full contact, where all curves meet, the sign of the excess is not examined.
    """
    loads, off = case["mean_pressure"], excess(case, method)
    below = np.flatnonzero((off < 0) & (numerical(case) < PARTIAL[1] * _total(case)))
    if not below.size:
        return float(loads[0])
    last = int(below[-1])
    if last + 1 == loads.size:
        return float(loads[-1])
    return float(np.interp(0.0, off[last : last + 2], loads[last : last + 2]))


def mean_error(case: Case, method: str) -> float:
    """Return the mean absolute excess up to full contact, over the compliance at full contact."""
    return _mean(*_between(case, np.abs(excess(case, method)), 0, 1)) / _total(case)


def mean_resistance_error(case: Case, method: str) -> float:
    """Return the mean absolute relative error of the resistance in partial contact."""
    loads, error = resistance_errors(case, method)
    return _mean(loads, np.abs(error))


def largest_rise_of_resistance(case: Case) -> float:
    """Return the largest rise of R from one load to the next, by any estimate and the most accurate method."""
    rows = [curve(case, method, "resistance") for method in (*ESTIMATES, curves.numerical_method(case))]
    return max(float((np.diff(row) / row.max()).max()) for row in rows)


def width_of_bounds(case: Case) -> float:
    """Return the mean relative width of the bounds on R over the mean relative width of the bounds on h."""
    widths = []
    for quantity in ("resistance", "compliance"):
        width = numerical(case, f"{quantity}_upper") - numerical(case, f"{quantity}_lower")
        loads, values = _between(case, width / np.maximum(numerical(case, quantity), ROUNDING), *INTERMEDIATE)
        widths.append(_mean(loads, values))
    return widths[0] / widths[1]


def later_full_contact(*dimensions: Case) -> float:
    """Return the ratio of the loads close to full contact of the last and the first case."""
    return _full_contact_load(dimensions[-1]) / _full_contact_load(dimensions[0])


def _full_contact_load(case: Case) -> float:
    """Return the first load close to full contact, or the last load."""
    close = numerical(case) >= curves.FULL_CONTACT_COMPLIANCE * _total(case)
    return float(case["mean_pressure"][np.argmax(close) if close.any() else -1])


def ensemble_mean(cases: Cases) -> Case:
    """Return the mean curves of an ensemble of phases, with the largest of their stated errors."""
    averaged = ("compliance", "resistance", "contact_fraction", "first_contact")
    largest = ("compliance_error", "resistance_error")
    values = {name: np.mean([case[name] for case in cases], axis=0) for name in averaged}
    values |= {name: np.max([case[name] for case in cases], axis=0) for name in largest}
    return {**cases[0], **values}


def excess_at_low_loads(case: Case, method: str) -> Array:
    """Return the excess at low loads."""
    return _between(case, excess(case, method), 0, LOW_COMPLIANCE)[1]


def mean_excess_at_high_loads(case: Case, method: str) -> float:
    """Return the mean excess at high loads."""
    return _mean(*_between(case, excess(case, method), LOW_COMPLIANCE, 1))


def error_at_low_loads(case: Case, method: str) -> float:
    """Return the largest absolute excess at low loads, over the compliance at full contact."""
    return _largest(excess_at_low_loads(case, method)) / _total(case)


def growth_of_error(method: str, *cases: Case) -> float:
    """Return the increase from first to last case of an estimate's largest error, relative to full contact."""
    first, last = (_largest(excess(case, method)) / _total(case) for case in (cases[0], cases[-1]))
    return last - first


def resistance_errors(case: Case, method: str, lowest: float = PARTIAL[0]) -> tuple[Array, Array]:
    """Return loads of partial contact, and the relative errors of the resistance by an estimate there."""
    exact = numerical(case, "resistance")
    with np.errstate(divide="ignore", invalid="ignore"):  # full contact is excluded below
        error = curve(case, method, "resistance") / exact - 1
    return _between(case, error, lowest, PARTIAL[1])


def resistance_range(case: Case, method: str) -> tuple[float, float]:
    """Return the smallest and the largest of `resistance_errors`."""
    error = resistance_errors(case, method)[1]
    return float(error.min()), float(error.max())


def mean_resistance_error_at_high_loads(case: Case, method: str) -> float:
    """Return the mean of `resistance_errors` at high loads."""
    return _mean(*resistance_errors(case, method, LOW_COMPLIANCE))


def layer_behind_others(case: Case, lightest: bool = False) -> float:
    """Return the rms error of R by the layer, minus the rms error by the better of the other estimates.

    With `lightest`, the range begins at the first load, and the mean is over the logarithm of the load.
    """
    found = {method: resistance_errors(case, method, 0.0 if lightest else PARTIAL[0]) for method in ESTIMATES}
    size = {
        method: np.sqrt(_mean(np.log(loads) if lightest else loads, error**2))
        for method, (loads, error) in found.items()
    }
    return float(size["layer"] - min(size["archard"], size["demelio"]))


def discretisation_ratio(case: Case) -> float:
    """Return the largest ratio of the relative errors of boundary elements in R and in h."""
    partial = _partial_contact(case)
    resistance, exact = (curve(case, method, "resistance")[partial] for method in ("bem", "patches"))
    return _largest(resistance / exact - 1) / (_largest(curve(case, "bem") - curve(case, "patches")) / _total(case))


def _change(shorter: Case, longer: Case) -> float:
    """Return the largest change of the mean gap between two series, in g_0."""
    gaps = [_total(case) - numerical(case) for case in (shorter, longer)]
    return _largest(gaps[1] - gaps[0])


def last_change(*lengths: Case) -> float:
    """Return the largest change of the mean gap with the last term, relative to full contact."""
    return _change(*lengths[-2:]) / _total(lengths[-1])


def last_change_over_others(*lengths: Case) -> float:
    """Return the largest change with the last term, divided by the smallest change with an earlier term."""
    return _change(*lengths[-2:]) / min(map(_change, lengths[:-2], lengths[1:-1]), default=np.inf)


def growth_of_area(*lengths: Case) -> float:
    """Return the largest ratio of contact fractions for successive numbers of terms, in partial contact."""
    ratios = [_area_ratio(shorter, longer) for shorter, longer in itertools.pairwise(lengths)]
    return float(max(ratio.max() for ratio in ratios))


def decay_of_area(*lengths: Case) -> float:
    """Return the geometric mean over the loads of the area ratio of the last two m, times gamma^(D-1)."""
    mean = np.exp(np.log(_area_ratio(*lengths[-2:])).mean())
    return float(mean * full_contact_pressure(1, float(lengths[-1]["D"]), float(lengths[-1]["gamma"])))


def _area_ratio(shorter: Case, longer: Case) -> Array:
    """Return the ratios of the contact fractions of two series at the loads of partial contact of the shorter one."""
    partial = _partial_contact(shorter)
    ratio: Array = numerical(longer, "contact_fraction")[partial] / numerical(shorter, "contact_fraction")[partial]
    return ratio


def _changes_of_resistance(lengths: Cases) -> tuple[Array, Array]:
    """Return loads of intermediate compliance, and the absolute relative change of R with the last term there."""
    shorter, longer = (numerical(case, "resistance") for case in lengths[-2:])
    with np.errstate(divide="ignore", invalid="ignore"):  # full contact is excluded below
        change = np.abs(longer / shorter - 1)
    return _between(lengths[-1], change, *INTERMEDIATE)


def mean_change_of_resistance(*lengths: Case) -> float:
    """Return the mean over the load of the absolute relative change of the resistance with the last term."""
    return _mean(*_changes_of_resistance(lengths))


def largest_change_of_resistance(*lengths: Case) -> float:
    """Return the largest absolute relative change of the resistance with the last term."""
    return _largest(_changes_of_resistance(lengths)[1])


def growth_of_count(*lengths: Case) -> float:
    """Return the factor of the number of contacts with the last term, mean over the load."""
    shorter, longer = (numerical(case, "patch_count") for case in lengths[-2:])
    return _mean(*_between(lengths[-1], longer / np.maximum(shorter, 1), *INTERMEDIATE))


def factor_of_independent_contacts(*lengths: Case) -> float:
    """Return the factor of the resistance of independent contacts with the last term, geometric mean."""
    shorter, longer = map(resistance_of_independent_contacts, lengths[-2:])
    with np.errstate(divide="ignore", invalid="ignore"):  # full contact is excluded below
        factor = np.log(longer / shorter)
    return float(np.exp(_mean(*_between(lengths[-1], factor, *INTERMEDIATE))))


def resistance_of_independent_contacts(case: Case) -> Array:
    """Return R of N equal contacts at even spacing, with the same N and total area; NaN in full contact.

    Each of them is the contact of one wave of wavelength 1/N: R = -(1/N) ln sin^2(pi A/2) by (8) and (13).
    """
    count, fraction = numerical(case, "patch_count"), numerical(case, "contact_fraction")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(-2 * np.log(np.sin(np.pi * fraction / 2)) / np.where(count > 0, count, np.nan))


def _wave_and_tail(case: Case, wave: Case) -> tuple[Array, float]:
    """Return the compliance of one wave, in closed form if available, and the amplitude G_1 of all finer ones."""
    exact = curves.curve(wave, "compliance", "westergaard")
    tail = float(tail_amplitude(1, float(case["D"]), float(case["gamma"])))
    return numerical(wave) if exact is None else exact, tail


def spread_over_bounds(case: Case, wave: Case) -> float:
    """Return the largest difference between estimates of the compliance, over the width of its bounds.

    Each estimate lies within the bounds h_1 and h_1 + 2 G_1 by construction: each finer wave adds between 0
    and g_n to h_1.
    """
    _, tail = _wave_and_tail(case, wave)
    return _largest(np.ptp([curve(case, method) for method in ESTIMATES], axis=0)) / (2 * tail)


def resistance_over_bounds(case: Case, wave: Case) -> float:
    """Return the largest ratio of an estimate of R to its upper bound, or of its lower bound to the estimate."""
    low, high = resistance_bounds(case["mean_pressure"], *_wave_and_tail(case, wave), 0.0)
    estimates = np.array([curve(case, method, "resistance") for method in ESTIMATES])
    return float(np.maximum(low / np.maximum(estimates, ROUNDING), estimates / high).max())
