"""Thin gaps in closed form: against Westergaard's solution, parabolas, and the same gaps as segments of their own."""

import numpy as np
import pytest

from tests.methods.patches.westergaard_states import KINDS
from weier import Profile
from weier.methods.patches import contacts, gaps, stages
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.inequalities import NEGATIVE
from weier.methods.patches.solver import make_solution
from weier.methods.patches.start import Starts, _make_guess
from weier.methods.patches.surface import intervals_between
from weier.methods.patches.thin_gaps import are_thin, find_thin_gaps

# Just below a merger: its gap is thin.
MERGING = Profile(1.1241528007905877, 2, 3, (3.731679150515029, 3.768119263993129, 0.9341084634895267))
MERGER = 0.80812372


# The same of gaps, of which the thin one is found in the pressure between them.
HEAVY = Profile(1.87106899647774, 5, 3, (5.58535798388015, 5.353055348199227, 4.092897663819084))
HEAVY_MERGER = 15.766205995466


def one(value):
    return np.array([value])


def uniform(contact, t):
    return np.ones_like(t)


@pytest.mark.parametrize("load", [1 - 1e-2, 1 - 1e-4, 1 - 1e-6])
def test_the_last_gap_of_one_wave(load, period):
    """Westergaard: h = L xi (1 - ln xi), R = -L ln xi, cos^2(pi b/L) = xi, as a wave of length L is L times as high.

    The images of the gap, which are left out, change R by the part (pi b/L)^2/4.
    """
    radius = 0.3 * period  # of a contact that reaches beyond the gap

    def pressure(contact, t):
        return load - np.cos(2 * np.pi * radius / period * (t - 0.2))

    reach = np.sqrt(2 * (1 - load)) * period / (2 * np.pi) / radius
    cracks, found = find_thin_gaps(pressure, uniform, one(0), one(0.2 + 0.3 * reach), one(reach), one(radius), period)
    b = period / np.pi * np.arcsin(np.sqrt(1 - load))
    images = (np.pi * b / period) ** 2
    assert found.tolist() == [True]
    assert cracks.middle[0] == pytest.approx(0.2, abs=1e-9)
    assert cracks.half_width[0] == pytest.approx(b, rel=images + 1e-9)
    assert cracks.reach[0] * radius == cracks.half_width[0]
    drop = period * (1 - load * (1 - np.log(load)))
    assert cracks.lift[0] == pytest.approx(drop, rel=images + 1e-14 / (1 - load) ** 2)
    assert cracks.rise[0] / (-period * np.log(load)) == pytest.approx(1 - images / 4, abs=images**2 + 1e-9)
    assert cracks.volume[0] == pytest.approx(period * cracks.lift[0], rel=1e-12, abs=0)


def test_a_gap_in_a_parabola_of_tension(period):
    """p = kappa x^2/2 - q_0: b^2 = 4 q_0/kappa, w = (pi/3) kappa (b^2-x^2)^(3/2) and p' = kappa."""
    curvature, depth, radius, q = 30.0, 1e-4, 0.2, 3.0
    b = np.sqrt(4 * depth / curvature)

    def pressure(contact, t):
        return 0.5 * curvature * (radius * t) ** 2 - depth

    def tangent(contact, t):
        return q * uniform(contact, t)

    reach = one(0.7 * b / radius)
    cracks, _ = find_thin_gaps(pressure, tangent, one(0), one(1e-3), reach, one(radius), period)
    assert cracks.half_width[0] == pytest.approx(b, rel=1e-9, abs=0)
    assert abs(cracks.middle[0]) < 1e-9
    assert cracks.strength[0] == pytest.approx(curvature * b**1.5 / np.sqrt(2), rel=1e-9, abs=0)
    assert cracks.tangent_strength[0] == pytest.approx(q * np.sqrt(b / 2), rel=1e-9, abs=0)
    assert cracks.volume[0] == pytest.approx(np.pi**2 * curvature * b**4 / 8, rel=1e-9, abs=0)
    assert cracks.lift[0] == pytest.approx(q * cracks.volume[0] / period, rel=1e-9, abs=0)
    assert cracks.rise[0] == pytest.approx(np.pi**2 * b**2 * q**2 / period, rel=1e-9, abs=0)


def test_a_crack_in_any_pressure_closes_smoothly_and_keeps_reciprocity():
    """The rise is the derivative of minus the lift by the load, for pressures with terms of higher degree."""
    radius, period, step = 0.3, 2.0, 1e-7

    def tangent(contact, t):
        return 1.3 + 0.4 * t + 0.6 * t**2

    def lift(load):
        def pressure(contact, t):
            return 20 * t**2 + 15 * t**3 + 9 * t**4 - 1e-2 + (load - 1) * tangent(contact, t)

        return find_thin_gaps(pressure, tangent, one(0), one(0.0), one(0.02), one(radius), period)[0]

    low, here, high = (lift(1 + change) for change in (-step, 0, step))
    assert here.rise[0] == pytest.approx(-(high.lift[0] - low.lift[0]) / (2 * step), rel=1e-6, abs=0)
    # The edges obey sum s_k = sum (-1)^k s_k = 0, that is the means of p and p tau with the weight 1/sqrt(1-tau^2).
    angle = (np.arange(20) + 0.5) * np.pi / 20
    t = here.middle + here.reach * np.cos(angle)
    p = 20 * t**2 + 15 * t**3 + 9 * t**4 - 1e-2
    assert abs(p.mean()) < 1e-12
    assert abs((p * np.cos(angle)).mean()) < 1e-12


def test_what_is_no_thin_gap_is_left():
    """A pressure that falls towards the end of the contact, and one without a minimum."""
    for pressure in (lambda c, t: 1e-3 - t, lambda c, t: -1 - t**2, lambda c, t: (t - 0.99) ** 2 - 1e-3):
        cracks, found = find_thin_gaps(pressure, uniform, one(0), one(0.9), one(0.05), one(0.3), 1.0)
        assert found.tolist() == [False]
        assert cracks.contact.size == 0


def test_gaps_are_thin_beside_their_neighbours_and_the_ends_of_a_contact():
    """All as wide, 2^(1/2) times 0.001; distances of 0.048 to each other and 0.049 to an end are too short."""
    negative = np.zeros(5, NEGATIVE)
    negative["segment"], negative["start"] = [0, 0, 1, 2, 3], [0.1, 0.15, 0.15, 0.95, -0.9]
    negative["end"] = negative["start"] + 0.002
    assert are_thin(negative, 0.02).tolist() == [False, False, True, False, True]
    assert are_thin(negative, 0.03).all()


def limit(monkeypatch, thinness):
    """Change the limit of thin gaps for contacts and for gaps."""
    monkeypatch.setattr(contacts, "MAX_THINNESS", thinness)
    monkeypatch.setattr(gaps, "MAX_THINNESS", thinness)


def between(state):
    """Middle and half-width of the intervals between the segments of a state, on a period of 1."""
    origin, centre, half_width = intervals_between(state.segments.extent, 1.0)
    return np.stack([origin + centre, half_width])


@pytest.mark.parametrize("below", [1e-6, 1e-7, 1e-9])
@pytest.mark.parametrize(("profile", "merger", "dual"), [(MERGING, MERGER, False), (HEAVY, HEAVY_MERGER, True)])
def test_thin_gaps_are_those_of_segments_of_their_own(profile, merger, dual, below, monkeypatch):
    """Separate contacts, and gaps with a segment for the thin one, to what the edge nearby changes."""
    load = merger * (1 - below)
    starts = Starts(profile, 1e-10)
    limit(monkeypatch, 1e-2 if dual else 1e-3)
    guess = starts.guess(load)
    if guess.kind is GAPS and not dual:
        guess = _make_guess(starts.surface.heights, load, CONTACTS, between(guess))
    thin, _ = stages.solve_in_stages(starts.surface, guess, 1e-10)
    assert thin.kind is KINDS[dual]
    contacts = make_solution(starts.surface, thin, load)
    limit(monkeypatch, 0.0)
    guess = thin if dual else _make_guess(starts.surface.tensions, load, GAPS, between(thin))
    assert guess.kind is GAPS
    gaps, _ = stages.solve_in_stages(starts.surface, guess, 1e-12)
    assert thin.cracks.contact.size == 1
    assert gaps.segments.centre.size + gaps.cracks.contact.size == contacts.centre.size
    of_gaps = make_solution(starts.surface, gaps, load)
    assert contacts.mean_gap == pytest.approx(of_gaps.mean_gap, abs=1e-13)
    assert thin.resistance == pytest.approx(gaps.resistance, abs=1e-11)
    np.testing.assert_allclose(contacts.edges, of_gaps.edges, atol=1e-8)
    if dual and below > 1e-8:
        assert gaps.cracks.contact.size == 0
        assert thin.cracks.rise[0] > 1e-3 * below
