"""Forecasts before anything is solved: first contact, full contact, number of contacts, compliance.

The formulas are those of docs/planned.md: "Expected errors" for first contact, and "Expected seconds" for how
contacts are counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need

from weier.kernels.arrays import Array
from weier.methods import bem, layer
from weier.methods.errors import ConvergenceError
from weier.methods.progress import reporting_to
from weier.surface.crests import SAMPLES_PER_WAVE, countable
from weier.surface.profile import Profile, terms_within

MAX_COUNTED_WAVES = 256  # The contacts of so many waves in a period are counted in 20 to 40 ms.
# Points for each of the finest waves, and residual in g_0, that suffice to count contacts.
COUNTED_POINTS, COUNTED_RESIDUAL = 16, 1e-5
# The loads at which they are counted, over the load of full contact.
COUNTED_LOADS = np.concatenate([np.geomspace(1e-9, 0.1, 17), np.arange(2, 10) / 10, [0.95, 0.98]])
TABLE_LOADS = np.geomspace(1e-4, 1e5, 226)  # The loads, in p_0*, of the table of expected compliances.


def full_contact_load(kept: Profile) -> float:
    """A load from which on contact is full, in p_0*: that of all waves where these can be sampled, else sum p_n*."""
    if countable(kept.waves_per_period[-1]):
        return kept.full_contact_load
    with np.errstate(over="ignore"):  # No load flattens a term whose p_n* is beyond the largest float.
        return float(kept.full_contact_pressure.sum())


def first_contact(profile: Profile, lengths: Sequence[int]) -> float:
    """A bound above the compliance at first contact, in g_0, from the highest of the sampled heights.

    Samples put the crest of the finest wave within (1 - cos(pi/16)) = 2 % of its amplitude.
    """
    kept = profile.truncated(max(k for k in lengths if countable(profile.truncated(k).waves_per_period[-1])))
    highest = float(kept.sampled_height(SAMPLES_PER_WAVE * kept.waves_per_period[-1]).max())
    return kept.total_amplitude - highest + 2 * profile.amplitude_beyond(kept.terms)


def contacts(kept: Profile, loads: Array) -> Array:
    """Expected contacts, shape (loads,), for nine of ten loads between half the true number and twice it.

    Those of the first terms are counted on a coarse grid, at loads that do not depend on those of the plan. The finer
    waves divide them: where a load is light, each wave within a contact may make another, and near full contact the
    profile looks like that of its first terms under the same fraction of the load of full contact.
    """
    if kept.m == 1:
        return np.ones(loads.size)
    coarse = kept.truncated(terms_within(kept, MAX_COUNTED_WAVES))
    counted, waves = _count(coarse), kept.waves_per_period[-1]
    number, fraction = _interpolate(counted, loads / coarse.full_contact_load)
    if coarse.m == kept.m:
        return number
    ratio = waves / coarse.waves_per_period[-1] * coarse.period / kept.period
    with np.errstate(over="ignore"):  # A p_n* may be beyond the largest float.
        flattened = kept.full_contact_pressure.sum() / coarse.full_contact_pressure.sum()
    alike, _ = _interpolate(counted, loads / flattened / coarse.full_contact_load)
    periods = kept.period / coarse.period
    return np.asarray(periods * np.minimum(number + fraction * waves / periods, ratio * alike))


@lru_cache(maxsize=32)
def _count(kept: Profile) -> tuple[Array, Array]:
    """The contacts of a short series in one period, and the fraction of its length, at the loads of the table."""
    points, loads = COUNTED_POINTS * kept.waves_per_period[-1], COUNTED_LOADS * kept.full_contact_load
    try:
        with reporting_to():  # These loads are not those of the curve.
            found = bem.curve(
                kept, loads, points=points, max_residual=COUNTED_RESIDUAL, with_resistance=False, staircase="kept"
            )
    except ConvergenceError:  # Then the most contacts that there can be are expected.
        return np.full(loads.size, float(kept.waves_per_period[-1])), COUNTED_LOADS
    return np.maximum(found.patch_count, 1.0), found.contact_fraction


def _interpolate(counted: tuple[Array, Array], relative_load: Array) -> tuple[Array, Array]:
    """Contacts and their fraction of the length between the loads of the table, or at its ends."""
    at, (number, fraction) = (np.log(relative_load), np.log(COUNTED_LOADS)), counted
    return np.exp(np.interp(*at, np.log(number))), np.interp(*at, fraction)


def compliance(kept: Profile, loads: Array) -> Array:
    """Compliance of the layer model, in g_0, of the shape of the loads, linear from no load to its table.

    The table has the same loads for all plans, so that a plan for a load does not depend on the others.
    """
    table = _layer_table(kept.D, float(kept.gamma), kept.terms)
    light, heavy = table.x[[0, -1]]
    return np.asarray(np.minimum(loads / light, 1) * table(np.clip(loads, light, heavy)))


@lru_cache(maxsize=32)
def _layer_table(D: float, gamma: float, terms: int) -> scipy.interpolate.CubicHermiteSpline:
    curve = layer.curve(TABLE_LOADS, D, gamma, terms)
    return scipy.interpolate.CubicHermiteSpline(TABLE_LOADS, curve.compliance, curve.resistance)
