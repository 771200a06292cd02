"""What a requested accuracy takes: the cheapest method that the measured laws and the bounds theorem allow."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier import laws, layer
from weier.bounds import resistance_bounds
from weier.loads import checked_loads
from weier.profile import Profile, RandomPhases

Array = NDArray[np.float64]

TOLERANCE = 1e-3
QUANTITIES = ("compliance", "resistance")
MOST_POINTS = 2**21  # a load then takes some seconds
MOST_CONTACTS = 256  # a dense matrix of more takes seconds a load
MOST_SAMPLES = 2**17  # where first contact is looked for
SAMPLES_PER_WAVE = 16  # put the crest of the finest wave within (1 - cos(pi/16)) = 2 % of its amplitude
TABLE = 100  # loads on which the bounds on the resistance are foreseen


class OutOfReachError(ValueError):
    """No method within reach is as accurate as asked."""


class Part(NamedTuple):
    """A range of loads and how it is solved.

    mean_pressure : shape (loads,), in p_0*
    method : "full contact", "westergaard", "demelio", "layer", "bem" or "patches"
    terms : of the series, that are modelled
    settings : of the method, as keywords of weier.solve
    truncation : by the bounds theorem, what the terms not modelled may change
    discretisation : by the measured laws, of a numerical method
    estimate : by the measured laws, of an estimate
    seconds, memory : expected; memory in bytes
    why : in a sentence
    """

    mean_pressure: Array
    method: str
    terms: float
    settings: Mapping[str, Any]
    truncation: float
    discretisation: float
    estimate: float
    seconds: float
    memory: float
    why: str

    @property
    def error(self) -> float:
        """All errors together."""
        return self.truncation + self.discretisation + self.estimate


@dataclass(frozen=True)
class Plan:
    """What to run, load by load; `print` it."""

    profile: Profile
    quantity: str
    tolerance: float
    parts: tuple[Part, ...]

    @property
    def error(self) -> float:
        """Largest expected error, in g_0 of a compliance, in the larger of itself and 1 of a resistance."""
        return max(part.error for part in self.parts)

    @property
    def seconds(self) -> float:
        """Expected seconds on one core."""
        return sum(part.seconds for part in self.parts)

    @property
    def memory(self) -> float:
        """Expected bytes beyond those of the interpreter."""
        return max(part.memory for part in self.parts)

    def __str__(self) -> str:
        """The plan to read: a line a part."""
        head = f"{self.profile.describe()}: {self.quantity} within {self.tolerance:g}"
        total = f"  in all: error {self.error:.1e}, {self.seconds:.2g} s, {self.memory / 1e6:.2g} MB"
        return "\n".join([head, *map(_line, self.parts), total])


def _line(part: Part) -> str:
    p = part.mean_pressure
    settings = "".join(f", {name} {value:g}" for name, value in part.settings.items())
    return (
        f"  {p.size} loads from {p[0]:.3g} to {p[-1]:.3g}: {part.method} with {part.terms:g} terms{settings}; "
        f"error {part.error:.1e} (truncation {part.truncation:.1e}, discretisation {part.discretisation:.1e}, "
        f"estimate {part.estimate:.1e}), {part.seconds:.2g} s, {part.memory / 1e6:.2g} MB: {part.why}"
    )


def plan(
    profile: Profile, mean_pressure: ArrayLike, tolerance: float = TOLERANCE, quantity: str = "compliance"
) -> Plan:
    """The cheapest way to a curve within a tolerance.

    Parameters
    ----------
    profile : Profile
        With any number of terms, inf too.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    tolerance : float
        Of the compliance, in g_0; of the resistance, relative to the larger of itself and 1 g_0/p_0*.
    quantity : "compliance" or "resistance"
        What is to be that accurate.

    Returns
    -------
    Plan
        Its parts cover the loads.

    Raises
    ------
    ValueError
        If the tolerance is not positive or the quantity unknown; OutOfReachError if no method can be that accurate.

    Notes
    -----
    Beyond the sum of all p_n* the contact is full, and h = sum g_n, R = 0. Below, terms of total amplitude G may be
    left out: by the bounds theorem they change the mean gap by G at most, so that h_k + G is within G (27).
    """
    loads = checked_loads(mean_pressure)
    _check(tolerance, quantity)
    full = _full_load(profile)
    partial, flat = loads[loads < full], loads[loads >= full]
    parts = []
    if partial.size:
        found = [way for way in _ways(profile, partial, tolerance, quantity) if way.error <= tolerance]
        if not found:
            raise OutOfReachError(_out_of_reach(profile, partial, tolerance, quantity))
        parts.append(min(found, key=lambda part: part.seconds))
    if flat.size:
        why = f"from {full:.3g} p_0* on, the sum of all p_n*, nothing is left to flatten"
        parts.append(Part(flat, "full contact", profile.m, {}, 0.0, 0.0, 0.0, 0.0, 0.0, why))
    return Plan(profile, quantity, tolerance, tuple(parts))


def truncated(profile: Profile, terms: int) -> Profile:
    """The first terms of a profile."""
    if isinstance(profile.phases, float | RandomPhases):
        return Profile(profile.D, profile.gamma, terms, profile.phases)
    return Profile(profile.D, profile.gamma, terms, profile.phases[:terms])


def left_out(profile: Profile, terms: float) -> float:
    """Amplitude of the terms from here on, in g_0."""
    if terms == profile.m:
        return 0.0
    return profile.total_amplitude - truncated(profile, int(terms)).total_amplitude


def _full_load(profile: Profile) -> float:
    """A load from which on contact is full: the pressure that flattens all waves falls nowhere below -sum p_n*."""
    if math.isinf(profile.m):
        return math.inf
    with np.errstate(over="ignore"):  # p_n* beyond the largest float: no load flattens that term
        return float(profile.full_contact_pressure.sum())


def _ways(profile: Profile, loads: Array, tolerance: float, quantity: str) -> Iterator[Part]:
    """All ways that might do, each at its cheapest setting for the tolerance."""
    if quantity == "compliance":  # no estimate knows the resistance of a few crests: errors of 100 % were measured
        yield from _estimates(profile, loads)
    for terms in _worth_trying(profile, quantity):
        kept = truncated(profile, terms)
        truncation = _truncation(profile, kept, loads, quantity)
        if truncation < tolerance:
            yield from _numerical(kept, loads, truncation, tolerance - truncation, quantity)


def _worth_trying(profile: Profile, quantity: str) -> list[int]:
    """Numbers of terms: for a resistance, which no bound holds tightly, all of them if that can be resolved."""
    lengths = list(_lengths(profile))
    return [int(profile.m)] if quantity == "resistance" and profile.m in lengths else lengths


def _lengths(profile: Profile) -> Iterator[int]:
    """Numbers of terms whose finest waves boundary elements can still see."""
    terms = 1
    while terms <= profile.m and truncated(profile, terms).wavenumber[-1] * laws.FEWEST_PER_WAVE <= MOST_POINTS:
        yield terms
        terms += 1


def _estimates(profile: Profile, loads: Array) -> Iterator[Part]:
    first, amplitude = _first_contact(profile), profile.total_amplitude - 1
    for method in ("demelio", "layer"):
        error = laws.estimate_error(method, first, amplitude)
        seconds, why = laws.SECONDS_LOAD[method] * loads.size, "an estimate whose measured error is small enough"
        yield Part(loads, method, profile.m, {}, 0.0, 0.0, error, seconds, 0.0, why)


def _first_contact(profile: Profile) -> float:
    """A bound above the compliance at first contact, in g_0: the highest of the sampled heights is reached."""
    terms = max(
        k for k in _lengths(profile) if truncated(profile, k).wavenumber[-1] * SAMPLES_PER_WAVE <= MOST_SAMPLES
    )
    kept = truncated(profile, terms)
    highest = float(kept.sampled_height(SAMPLES_PER_WAVE * kept.wavenumber[-1]).max())
    return kept.total_amplitude - highest + 2 * left_out(profile, terms)


def _truncation(profile: Profile, kept: Profile, loads: Array, quantity: str) -> float:
    """What the terms left out may change, by the bounds theorem."""
    amplitude = left_out(profile, kept.m)
    if quantity == "compliance" or amplitude == 0:
        return amplitude
    # Foreseen on the layer model's curve, which is near enough to tell how wide the bounds will be.
    p = np.unique(np.concatenate([loads, np.geomspace(loads[0] / 10, loads[-1] * 10, TABLE)]))
    low, high = resistance_bounds(p, layer.compliance(p, kept.D, float(kept.gamma), kept.m), amplitude)
    return float(np.max((high - low)[np.isin(p, loads)] / 2 / np.maximum(low[np.isin(p, loads)], 1)))


def _numerical(kept: Profile, loads: Array, truncation: float, error: float, quantity: str) -> Iterator[Part]:
    """Boundary elements and contact patches that leave no more than this error."""
    waves, terms = kept.wavenumber[-1], kept.m
    if terms == 1:
        seconds = laws.SECONDS_LOAD["westergaard"] * loads.size
        yield Part(loads, "westergaard", 1, {}, truncation, 0.0, 0.0, seconds, 0.0, "one wave has a closed form")
        return
    points = laws.bem_points(kept, error, quantity)
    if points <= MOST_POINTS:
        law = laws.bem_compliance_error if quantity == "compliance" else laws.bem_resistance_error
        why = f"{points / waves:.0f} points for each of {waves} waves are the fewest that do"
        seconds, memory = laws.bem_seconds(points, loads.size), laws.bem_bytes(points)
        settings = {"points": points}
        yield Part(loads, "bem", terms, settings, truncation, law(kept, points), 0.0, seconds, memory, why)
    able = [limit for limit in laws.PATCHES_TOLERANCES if laws.patches_error(limit, quantity) <= error]
    if waves <= MOST_CONTACTS and able:
        miss = laws.patches_error(able[0], quantity)
        why = f"exact edges of at most {waves} contacts cost less than a grid so fine"
        seconds, memory = laws.patches_seconds(waves, loads.size), laws.patches_bytes(waves)
        yield Part(loads, "patches", terms, {"tolerance": able[0]}, truncation, miss, 0.0, seconds, memory, why)


def _out_of_reach(profile: Profile, loads: Array, tolerance: float, quantity: str) -> str:
    terms = list(_lengths(profile))[-1]
    rest = _truncation(profile, truncated(profile, terms), loads, quantity)
    return (
        f"tolerance must be larger, or the series shorter, got {tolerance:g} for the {quantity} of "
        f"{profile.describe()}: {terms} terms are the most that can be resolved, and the others may change it by "
        f"{rest:.1e}"
    )


def _check(tolerance: float, quantity: str) -> None:
    if quantity not in QUANTITIES:
        raise ValueError(f"quantity must be one of {', '.join(QUANTITIES)}, got {quantity!r}")
    if not 0 < tolerance < math.inf:
        raise ValueError(f"tolerance must be positive and finite, got {tolerance}")
