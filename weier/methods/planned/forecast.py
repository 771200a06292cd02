"""What is known of a contact before anything is solved: first contact, full contact, how many contacts to expect."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need

from weier.kernels.arrays import Array
from weier.methods import demelio, layer, westergaard
from weier.methods.patches.surface import Surface, surface_of
from weier.theory.crests import SAMPLES_PER_WAVE, countable
from weier.theory.profile import Profile

CONTACTS_PER_WAVE = 0.1  # for each of the finest waves, where these are too many to be looked at
TABLE_LOADS = np.geomspace(1e-4, 1e5, 226)  # p_0*, on which a compliance is foreseen


@lru_cache(maxsize=8)
def _surface(kept: Profile) -> Surface:
    return surface_of(kept)


def full_contact_load(kept: Profile) -> float:
    """A load from which on contact is full, in p_0*: that which flattens all waves, or the sum of all p_n*."""
    if countable(kept.waves_per_period[-1]):
        return _surface(kept).full_contact_load
    with np.errstate(over="ignore"):  # p_n* beyond the largest float: no load flattens that term
        return float(kept.full_contact_pressure.sum())


def first_contact(profile: Profile, lengths: Sequence[int]) -> float:
    """A bound above the compliance at first contact, in g_0: the highest of the sampled heights is reached.

    Samples put the crest of the finest wave within (1 - cos(pi/16)) = 2 % of its amplitude.
    """
    kept = profile.truncated(max(k for k in lengths if countable(profile.truncated(k).waves_per_period[-1])))
    highest = float(kept.sampled_height(SAMPLES_PER_WAVE * kept.waves_per_period[-1]).max())
    return kept.total_amplitude - highest + 2 * profile.amplitude_beyond(kept.terms)


def contacts(kept: Profile, loads: Array) -> Array:
    """Contacts to expect, shape (loads,), for nine of ten loads between a third of the true number and twice it.

    Crests that reach a plane at Demelio's compliance. Gaps are as many as contacts, and each needs a trough that full
    contact would put in tension: the fewer of the two counts.
    """
    if not countable(kept.waves_per_period[-1]):
        return np.full(loads.size, kept.waves_per_period[-1] * CONTACTS_PER_WAVE)
    surface, ratio = _surface(kept), float(kept.gamma)
    approach = np.maximum(demelio.compliance(loads, kept.D, ratio, kept.m), 2 * westergaard.compliance(loads))
    crests = np.searchsorted(np.sort(-surface.heights.crest_offset), approach, side="right")
    tension = surface.full_contact_load - loads
    troughs = np.searchsorted(np.sort(-surface.tensions.crest_offset), tension, side="right")
    return np.maximum(np.minimum(crests, troughs), 1).astype(float)


def compliance(kept: Profile, loads: Array) -> Array:
    """Compliance of the layer model, in g_0, of the shape of the loads: straight from no load to its table.

    The table has the same loads whatever is asked for, so that a plan for a load does not depend on the others.
    """
    table = _layer_table(kept.D, float(kept.gamma), kept.terms)
    light, heavy = table.x[[0, -1]]
    return np.asarray(np.minimum(loads / light, 1) * table(np.clip(loads, light, heavy)))


@lru_cache(maxsize=32)
def _layer_table(D: float, gamma: float, terms: int) -> scipy.interpolate.CubicHermiteSpline:
    curve = layer.curve(TABLE_LOADS, D, gamma, terms)
    return scipy.interpolate.CubicHermiteSpline(TABLE_LOADS, curve.compliance, curve.resistance)
