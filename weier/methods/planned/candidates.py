"""The ways to a curve that a plan chooses from: full contact, estimates, the layer, grids and contact patches.

Each has its cheapest setting that meets the tolerance somewhere, with its errors and seconds at every load.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import islice
from typing import Any

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need
from numpy.typing import NDArray

from weier.methods import demelio, laws, layer, westergaard
from weier.methods.hybrid.solver import LOADS, MOST_POINTS, POINTS_PER_WAVE
from weier.methods.patches.surface import Surface, surface_of
from weier.methods.planned.segment import Part
from weier.theory.profile import Profile
from weier.theory.terms import left_out, truncated

Array = NDArray[np.float64]

MOST_GRID_POINTS = 2**21  # a load then takes a second
MOST_CONTACTS = 256  # a dense matrix of more takes seconds a load
MOST_FORESEEN = 64  # contacts of a plan where there are over 256 waves: the forecast may be 4 times too low
MOST_SAMPLES = 2**17  # where first contact is looked for
SAMPLES_PER_WAVE = 16  # put the crest of the finest wave within (1 - cos(pi/16)) = 2 % of its amplitude
UNSEEN = 0.1  # contacts for each of the finest waves, where these are too many to look at
SERIES = 4  # numbers of terms to compare, from the fewest whose tail the tolerance allows
BOUND_SHARE = 0.1  # of the amplitude left out, that a method may be off where it finds bounds on the resistance
SHARES = np.geomspace(1e-6, 0.999, 120)  # of a load, by which another is lighter; the same of heavier ones
FORESEEN = np.geomspace(1e-4, 1e5, 226)  # p_0*, on which the bounds on the resistance are foreseen
HEAVIEST = 1e300  # p_0*: more is foreseen as this, since ten times as much is a number


def ways(profile: Profile, loads: Array, tolerance: float, quantity: str) -> Iterator[Part]:
    """All ways that might do, each at its cheapest setting; their error is infinite where they say nothing."""
    lengths = list(resolved_lengths(profile))
    yield from _flattened(profile, lengths, loads, tolerance, quantity)
    if quantity == "compliance":  # no estimate knows the resistance of a few crests: errors of 100 % were measured
        yield from _estimates(profile, loads)
        if math.isinf(profile.m):
            yield from _resolved_in_part(profile, lengths, loads, tolerance)
    for terms in _worth_trying(profile, lengths, tolerance, quantity):
        kept, amplitude = truncated(profile, terms), left_out(profile, terms)
        if quantity == "resistance" and amplitude > 0:
            yield from _between_chords(kept, loads, amplitude)
        elif amplitude < tolerance:
            yield from _numerical(kept, loads, np.full(loads.size, amplitude), tolerance - amplitude, quantity)


def resolved_lengths(profile: Profile) -> Iterator[int]:
    """Numbers of terms whose finest waves boundary elements can still see."""
    terms = 1
    while terms <= profile.m and truncated(profile, terms).wavenumber[-1] * laws.FEWEST_PER_WAVE <= MOST_GRID_POINTS:
        yield terms
        terms += 1


def _worth_trying(profile: Profile, lengths: Sequence[int], tolerance: float, quantity: str) -> list[int]:
    """Numbers of terms: for a resistance, which no bound holds tightly, all of them if that can be resolved.

    If not, the bounds are narrower the more terms are resolved, and how many a load needs depends on the load.
    """
    if profile.m in lengths and quantity == "resistance":
        return [int(profile.m)]
    if quantity == "resistance":
        return list(lengths)
    enough = (terms for terms in lengths if left_out(profile, terms) < tolerance)
    return sorted({*islice(enough, SERIES), lengths[-1]})


def _flattened(
    profile: Profile, lengths: Sequence[int], loads: Array, tolerance: float, quantity: str
) -> Iterator[Part]:
    """Full contact of the terms that the tolerance needs: closed form, free."""
    finite = [] if math.isinf(profile.m) else [int(profile.m)]
    few = [terms for terms in lengths if left_out(profile, terms) / 2 <= tolerance][:1]
    for terms in {*finite, *few} if quantity == "compliance" else finite:
        full = _full_load(truncated(profile, terms))
        error = np.where(loads >= full, left_out(profile, terms) / 2, np.inf)
        what = (
            "nothing is left to flatten" if terms == profile.m else "what follows changes that by half of its height"
        )
        why = f"from {full:.3g} p_0* on these terms are flat, and {what}"
        yield _closed_form("full contact", loads, terms, why, truncation=error)


def _closed_form(method: str, loads: Array, terms: float, why: str, **others: Any) -> Part:
    none = np.zeros(loads.size)
    known = {"truncation": none, "discretisation": none, "estimate": none} | others
    start, load = (table.get(method, 0.0) for table in (laws.SECONDS_START, laws.SECONDS_LOAD))
    return Part(
        loads, method, terms, settings={}, seconds_start=start, seconds_load=none + load, memory=0.0, why=why, **known
    )


@lru_cache(maxsize=8)
def _surface(kept: Profile) -> Surface:
    return surface_of(kept)


def _seen(kept: Profile) -> bool:
    """Whether every crest of a series can be looked at before anything is solved."""
    return kept.wavenumber[-1] * SAMPLES_PER_WAVE <= MOST_SAMPLES


def _full_load(kept: Profile) -> float:
    """A load from which on contact is full: that of the pressure which flattens all waves, or the sum of all p_n*."""
    if _seen(kept):
        return _surface(kept).full_contact_load
    with np.errstate(over="ignore"):  # p_n* beyond the largest float: no load flattens that term
        return float(kept.full_contact_pressure.sum())


def _estimates(profile: Profile, loads: Array) -> Iterator[Part]:
    first, amplitude = _first_contact(profile), profile.total_amplitude - 1
    for method in ("demelio", "layer"):
        error = laws.estimate_error(method, loads, profile.D, first, amplitude)
        yield _closed_form(
            method, loads, profile.m, "an estimate whose measured error is small enough", estimate=error, whole=True
        )


def _first_contact(profile: Profile) -> float:
    """A bound above the compliance at first contact, in g_0: the highest of the sampled heights is reached."""
    terms = max(k for k in resolved_lengths(profile) if _seen(truncated(profile, k)))
    kept = truncated(profile, terms)
    highest = float(kept.sampled_height(SAMPLES_PER_WAVE * kept.wavenumber[-1]).max())
    return kept.total_amplitude - highest + 2 * left_out(profile, terms)


def _resolved_in_part(profile: Profile, lengths: Sequence[int], loads: Array, tolerance: float) -> Iterator[Part]:
    """The coarse terms on a layer of all finer ones, with as few of them as some load allows."""
    carried = (LOADS[0] <= loads) & (loads <= LOADS[1])
    for terms in lengths:
        kept = truncated(profile, terms)
        points = POINTS_PER_WAVE * kept.wavenumber[-1]
        if points > MOST_POINTS:
            return
        error = np.where(carried, laws.endless_error(loads, kept), np.inf)
        mesh = np.full(loads.size, laws.bem_compliance_error(kept, points))
        if np.any(error + mesh <= tolerance):
            start, load = laws.endless_seconds(points)
            none = np.zeros(loads.size)
            yield Part(
                loads,
                "endless",
                terms,
                settings={"points": points},
                truncation=none,
                discretisation=mesh,
                estimate=error,
                seconds_start=start,
                seconds_load=none + load,
                memory=laws.grid_bytes("endless", points),
                why=f"on a layer of all finer terms, {kept.tail_amplitude:.1e} g_0 in all",
                whole=True,
            )
            if np.all(error + mesh <= tolerance):
                return


def truncation_error(profile: Profile, kept: Profile, loads: Array, quantity: str) -> Array:
    """What the terms left out may change, by the bounds theorem."""
    amplitude = left_out(profile, kept.m)
    if quantity == "compliance" or amplitude == 0:
        return np.full(loads.size, amplitude)
    return _foreseen_chords(kept, loads, amplitude)[0]


def _between_chords(kept: Profile, loads: Array, amplitude: float) -> Iterator[Part]:
    """The resistance of a longer series from the compliance of these terms: a concave curve lies below its tangents.

    The chords to two more loads, a lighter and a heavier one, hold the slope at each load: it takes three solutions.
    """
    miss = BOUND_SHARE * amplitude
    width, chord_loads = _foreseen_chords(kept, loads, amplitude + miss)
    for part in _numerical(kept, loads, width, miss, "compliance"):
        yield part._replace(
            discretisation=np.where(np.isfinite(part.discretisation), 0.0, np.inf),
            chord_loads=chord_loads,
            seconds_load=(1 + chord_loads.shape[1]) * part.seconds_load,
            why=f"{part.why}; chords to a lighter and a heavier load hold the resistance of the longer series",
        )


def _foreseen_chords(kept: Profile, loads: Array, amplitude: float) -> tuple[Array, Array]:
    """How far apart the best chords will be, over the larger of the resistance and 1, and the loads they lead to.

    Foreseen on the layer model's curve, load by load: no load knows of another.
    """
    p = np.minimum(loads, HEAVIEST)[:, None]
    here, lighter, heavier = foreseen_compliance(kept, p), p * (1 - SHARES), p / (1 - SHARES)
    steepest = (here - foreseen_compliance(kept, lighter) + 2 * amplitude) / (p - lighter)
    flattest = (foreseen_compliance(kept, heavier) - here - 2 * amplitude) / (heavier - p)
    best = steepest.argmin(axis=1, keepdims=True), flattest.argmax(axis=1, keepdims=True)
    chord_loads = [np.take_along_axis(*each, axis=1) for each in zip((lighter, heavier), best, strict=True)]
    start = ((here + 2 * amplitude) / p)[:, 0]  # the chord from no load, which needs no solution
    upper, lower = np.minimum(steepest.min(axis=1), start), np.maximum(flattest.max(axis=1), 0)
    return (upper - lower) / np.maximum(lower, 1), np.hstack(chord_loads)


def foreseen_compliance(kept: Profile, loads: Array) -> Array:
    """Compliance of the layer model, in g_0, of the shape of the loads: straight from no load to its table."""
    table = _layer_table(kept.D, float(kept.gamma), kept.terms)
    light, heavy = table.x[[0, -1]]
    return np.asarray(np.minimum(loads / light, 1) * table(np.clip(loads, light, heavy)))


@lru_cache(maxsize=32)
def _layer_table(D: float, gamma: float, terms: int) -> scipy.interpolate.CubicHermiteSpline:
    """Of the same loads whatever is asked for, so that a plan for a load does not depend on the other loads."""
    curve = layer.curve(FORESEEN, D, gamma, terms)
    return scipy.interpolate.CubicHermiteSpline(FORESEEN, curve.compliance, curve.resistance)


def _numerical(kept: Profile, loads: Array, truncation: Array, error: float, quantity: str) -> Iterator[Part]:
    """Boundary elements and contact patches that leave no more than this error."""
    if kept.terms == 1:
        why = "one wave has a closed form"
        yield _closed_form("westergaard", loads, 1, why, truncation=truncation)
        return
    count = contacts(kept, loads) if _seen(kept) else np.full(loads.size, kept.wavenumber[-1] * UNSEEN)
    left = laws.RESIDUAL * laws.BEM_RESIDUAL if quantity == "compliance" else 0.0
    if error > left and (points := laws.bem_points(kept, error - left, quantity)) <= MOST_GRID_POINTS:
        yield _on_grid(kept, points, count, loads, truncation, quantity)
    able = [limit for limit in laws.PATCHES_TOLERANCES if laws.patches_error(limit, quantity) <= error]
    if able and _seen(kept):
        yield _by_contacts(kept, able[0], count, loads, truncation, quantity)


def _on_grid(kept: Profile, points: int, count: Array, loads: Array, truncation: Array, quantity: str) -> Part:
    if quantity == "compliance":
        miss = np.full(loads.size, laws.bem_compliance_error(kept, points) + laws.RESIDUAL * laws.BEM_RESIDUAL)
    else:
        miss = laws.bem_resistance_error(kept, points, loads)
    start, load = laws.bem_seconds(points, count)
    waves = kept.wavenumber[-1]
    return Part(
        loads,
        "bem",
        kept.terms,
        settings={"points": points},
        truncation=truncation,
        discretisation=miss,
        estimate=np.zeros(loads.size),
        seconds_start=start,
        seconds_load=load,
        memory=laws.grid_bytes("bem", points),
        why=f"{points / waves:.0f} points for each of {waves} waves are the fewest that do",
    )


def _by_contacts(kept: Profile, limit: float, count: Array, loads: Array, truncation: Array, quantity: str) -> Part:
    waves = kept.wavenumber[-1]
    most = MOST_CONTACTS if waves <= MOST_CONTACTS else MOST_FORESEEN
    return Part(
        loads,
        "patches",
        kept.terms,
        settings={"tolerance": limit},
        truncation=truncation,
        discretisation=np.where(count <= most, laws.patches_error(limit, quantity), np.inf),
        estimate=np.zeros(loads.size),
        seconds_start=laws.SECONDS_START["patches"],
        seconds_load=laws.patches_seconds(waves, count),
        memory=laws.patches_bytes(waves, min(most, count.max())),
        why="exact edges of as few contacts cost less than a grid so fine",
    )


def contacts(kept: Profile, loads: Array) -> Array:
    """Contacts to expect, shape (loads,), in nine of ten loads between a third and twice of the truth.

    Crests that reach a flat at Demelio's compliance. Gaps are as many as contacts, and each needs a trough that full
    contact would put in tension: the fewer of the two counts.
    """
    seen, ratio = _surface(kept), float(kept.gamma)
    near = np.maximum(demelio.compliance(loads, kept.D, ratio, kept.m), 2 * westergaard.compliance(loads))
    crests = np.searchsorted(np.sort(-seen.heights.crest_offset), near, side="right")
    troughs = np.searchsorted(np.sort(-seen.tensions.crest_offset), seen.full_contact_load - loads, side="right")
    return np.maximum(np.minimum(crests, troughs), 1).astype(float)
