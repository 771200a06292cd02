"""How far the resistance of a state may be off: an estimate by edges, cracks and contacts that may be born.

All of it follows from what heights that are off by the error of the state do to the contacts (docs/numerics.md). Of
the loads that were tried the error was within the estimate, by a factor of 1.7 at least.
"""

from __future__ import annotations

import numpy as np

from weier.methods.patches.inequalities import NEW_GAP_WIDTH, gap_uncertainty
from weier.methods.patches.newton import SENSITIVITY_TOLERANCE
from weier.methods.patches.segments import (
    ContactState,
    at_contacts,
    contacts_of,
    distances_between,
    segment_strengths,
)
from weier.methods.patches.surface import TWIN_HEIGHT, CosineSeries, nearest_crests

RATE_ERROR = 5 * SENSITIVITY_TOLERANCE  # of the resistance: what is left when its own corrections end
EDGE_FACTOR = 2.0  # over what the edges tell: neighbours, which the formulas leave out, move as well
CRACK_FACTOR = 2.0  # of what a crack adds to the resistance: its width is known from an interval of tension, roughly
EPS = float(np.finfo(float).eps)


def resistance_error(state: ContactState, series: CosineSeries, total_amplitude: float) -> float:
    """An estimate of the error of the resistance in partial contact, in g_0/p_0*."""
    by_edges = EDGE_FACTOR * _error_by_edges(state, series, total_amplitude)
    by_cracks = CRACK_FACTOR * _rise_by_cracks(state, series.period)
    return RATE_ERROR * max(state.resistance, 1.0) + by_edges + by_cracks + _drop_by_births(state, series)


def _rise_by_cracks(state: ContactState, period: float) -> float:
    """What gaps in the intervals of tension would add to the resistance, in g_0/p_0*.

    A gap in a parabola of tension is 2^(1/2) times as wide as the interval. One of half-width b adds pi^2 b^2 q^2/L,
    where an increment of the load adds q to the pressure there. For a lone contact that is K (2/r)^(1/2)/sqrt(1-t^2),
    with K as at its edges; and where gaps are narrow it is about 1.
    """
    if state.tensions.size == 0:
        return 0.0
    of, t, b = state.tensions.T
    contact = of.astype(np.int64)
    r = contacts_of(state.segments.extent, state.dual, period)[2][contact]
    K = at_contacts(state.singular_rate, state.dual)[contact].mean(axis=1)
    q = np.maximum(K * np.sqrt(2 / (r * (1 - t**2))), 1.0)
    return float(np.pi**2 / period * np.sum((NEW_GAP_WIDTH * b * r * q) ** 2))


def _drop_by_births(state: ContactState, series: CosineSeries) -> float:
    """By how much contacts may lower the resistance, in g_0/p_0*, that may be born in narrow gaps.

    A gap g that may be off by e leaves a contact that penetrates by e - g at most. Where the plane cuts the crest at
    the half-width b, the contact sinks in by c = -2 ln(pi b/L) or more for each unit of force, less what the nearest
    other contact gives way. The plane nears the crest by t = R - u' for each unit of mean pressure, where the
    displacement u' of the crest is nowhere below -2 L ln 2. So the contact takes the force t/c of it, which lowers
    the resistance by t^2/(c L).
    """
    gaps, period = state.narrow_gaps, series.period
    if gaps.size == 0:
        return 0.0
    depth = gap_uncertainty(state.height_error, series) - gaps["value"]
    half_width = np.sqrt(2 * depth / np.maximum(gaps["curvature"], depth / period**2))
    compliance = -2 * np.log(np.minimum(np.pi * half_width / period, np.exp(-0.5)))
    origin, centre, r = contacts_of(state.segments.extent, state.dual, period)
    distance = np.abs(np.sin(np.pi / period * (gaps["position"][:, None] - (origin + centre))))
    relief = -2 * np.log(np.pi * r / period) + 4 * np.log(2 * distance)
    compliance += np.minimum(relief.min(axis=1), 0.0)
    closing = state.resistance + 2 * np.log(2.0) * period
    return min(float(np.sum(closing**2 / (np.maximum(compliance, 1.0) * period))), state.resistance)


def _error_by_edges(state: ContactState, series: CosineSeries, total_amplitude: float) -> float:
    """How far the resistance may be off by edges, in g_0/p_0*, where heights are off by the error e of the state.

    An edge that moves out by delta lowers the resistance by 2 pi^2 K^2 delta/L, where an increment of the load adds
    the pressure K/s^(1/2) beside it: for the contact of a force, this is the derivative of -2 ln(pi a/L). Beside an
    edge where the pressure is A s^(1/2), heights that are off by e here and by -e elsewhere add about
    e/(2^(1/2) pi l^(1/2) s^(1/2)), with l the half-width of the contact or of the gap, the lesser: so much does a
    curvature of 2 e/a^2 to Hertz's contact, and half as much the tension e/(2 pi b) to a crack. The edge moves until
    that is gone.

    A light contact also takes another force, by 2 e/c with c = -2 ln(pi a/L), and moves both of its edges by
    a e/(c F). Crests other than the highest and its twins are known to a unit in the last place of the amplitudes,
    and curvatures to one in that of the waves' curvatures. The force follows from the pressure at the edges of the
    contact, as if that were Hertz's.
    """
    period, contacts = series.period, contacts_of(state.segments.extent, state.dual, series.period)
    origin, centre, r = contacts
    crest, _ = nearest_crests(series, origin + centre)
    lower = series.crest_offset[crest] < -TWIN_HEIGHT * total_amplitude
    of_height = state.height_error + EPS * total_amplitude * lower
    strength = np.maximum(at_contacts(np.abs(segment_strengths(state)), state.dual), 1e-300)
    force = np.pi / np.sqrt(8) * r**1.5 * strength.mean(axis=1)
    c = np.maximum(-2 * np.log(np.pi * r / period), 1.0)
    rounding = EPS * float(np.abs(series.amplitude) @ series.wavenumber**2)
    of_both = 2 * of_height / (c * force) + rounding * r**2 / (4 * force)  # over the half-width
    gap = 0.5 * distances_between(*contacts, period)
    beside = np.stack([np.roll(gap, 1), gap], axis=1)
    scale = np.minimum(r[:, None], beside)
    of_each = np.sqrt(2) / np.pi * of_height[:, None] / (strength * np.sqrt(scale))
    move = of_each + (r * of_both)[:, None]
    # An edge that may move by its scale may be that of no contact or of no gap. The factor is for what is not known
    # of one that has hardly begun.
    least = np.where(beside < r[:, None], beside, (r * c)[:, None])
    move = np.where(move < scale, move, 2 * least)
    K = at_contacts(state.singular_rate, state.dual)
    return float(2 * np.pi**2 / period * np.sum(K**2 * move))
