"""Crests of tension or height that are flat to fourth and sixth order: closed forms, guards, and events."""

import numpy as np
import pytest

import weier
from weier import ConvergenceError, Trace
from weier.accuracy.cosines import Cosines
from weier.methods import patches
from weier.methods.patches import inequalities, segments, stages, start
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.surface import make_series, surface_of

# Amplitudes of cos(n y), n = 1, 2, 3, whose derivatives vanish at y = 0 up to the third and fifth order.
FLAT = {2: np.array([1.0, -1 / 4]), 3: np.array([1.0, -2 / 5, 1 / 15])}
BELOW = 10.0 ** -np.arange(0.05, 15, 0.65)  # relative distance from full contact, or from first contact


def flat(order, waves, phase, of_tension, samples=40):
    """Trace whose tension or height has one crest a wave, flat to the derivative 2 order - 1, and its full load."""
    n, x = np.arange(1, order + 1), np.arange(samples)[:, None] / samples
    amplitude = -FLAT[order] / n if of_tension else FLAT[order]
    heights = np.cos(n * (2 * np.pi * waves * x + phase)) @ amplitude
    trace = Trace(1e-6 * heights, 1e-3, ends="periodic", unit="m")
    return trace, surface_of(trace).full_contact_load


def assert_stated(error, stated):
    assert np.all(error <= stated)
    assert np.all(stated[BELOW > 1e-9] <= 1e-6)  # and the statement is not empty


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize(("waves", "phase"), [(1, 0.0), (2, 0.0), (3, 0.3), (1, 1.1)])
def test_gaps_on_flat_crests_of_the_tension(order, waves, phase):
    """One contact a wave of length l has R = -l ln(1 - B), B = sin^2(pi b/l), for any load p(B).

    The tension is (2/pi) int S dtheta/2 with sin(pi x/l) = sin(pi b/l) sin(theta): 1 - B^n here, over the full load.
    """
    trace, full = flat(order, waves, phase, True)
    curve = patches.curve(trace, full * (1 - BELOW))
    below = 1 - full * (1 - BELOW) / full
    B = below ** (1 / order)
    assert_stated(abs(curve.resistance + np.log1p(-B) / waves), curve.resistance_error)
    if order == 2:  # h = sum g_n - int R dp, as a series in B, which is at most 0.95
        k = np.arange(1, 600)[:, None]
        h = trace.total_amplitude - full / waves * (2 * B ** (k + 2) / (k * (k + 2))).sum(axis=0)
        assert_stated(abs(curve.compliance - h), curve.compliance_error)
    assert start.isolated_gaps(surface_of(trace).tensions, full * (1 - 1e-8)) is not None


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize(("waves", "phase"), [(1, 0.7), (2, 0.0), (3, 0.3)])
def test_light_contacts_on_flat_crests_of_the_height(order, waves, phase):
    """R = -l ln A, A = sin^2(pi a/l), and the load is proportional to A^n."""
    trace, full = flat(order, waves, phase, False)
    curve = patches.curve(trace, full * BELOW[::-1])
    exact = -np.log(BELOW[::-1]) / order / waves
    assert np.all(abs(curve.resistance - exact) <= curve.resistance_error)
    assert np.all(curve.resistance_error <= 1e-6 * exact)
    assert np.all(curve.patch_count == waves)


def test_guesses_on_flat_crests_are_near_the_contacts():
    """Two flat crests of different height with unlike forces, and a gap."""
    surface = Cosines(np.array([1e-6, 1.0, 0.25]), [1, 2, 4], np.array([0.3, 0.0, np.pi]))
    for load in (3e-7, 1e-6):
        found, exact = start.isolated_contacts(surface_of(surface).heights, load), patches.solve_load(surface, load)
        np.testing.assert_allclose(found.segments.half_width, np.sort(exact.half_width), rtol=0.02)
    trace, full = flat(2, 1, 0.3, True)
    found, exact = start.isolated_gaps(surface_of(trace).tensions, full * (1 - 1e-6)), np.arcsin(1e-3**0.5) / np.pi
    assert found.segments.half_width == pytest.approx([exact], rel=1e-3)


@pytest.mark.parametrize("samples", [20, 40, 64])
@pytest.mark.parametrize("waves", [1, 2])
def test_curvatures_that_rounding_leaves_are_not_divided_by(samples, waves):
    """They are -2e-14 to 6e-13: NaN half-widths were nodes without number."""
    trace, full = flat(2, waves, 0.0, True, samples)
    curve = weier.solve(trace, full * np.array([0.1, 0.67, 0.9]), method="patches")
    B = np.sqrt([0.9, 0.33, 0.1])
    np.testing.assert_allclose(curve.resistance, -np.log(1 - B) / waves, rtol=1e-9)
    if waves == 2:
        assert float(curve.compliance[1]) == pytest.approx(1.402924530549, abs=2e-12)


@pytest.mark.parametrize("change", [1e-12, 1e-9, 1e-6, 1e-3, -1e-12, -1e-9, -1e-6, -1e-3])
def test_crests_that_are_almost_flat_are_solved_and_have_their_events(change):
    """Positive changes divide the crest in two, negative ones leave a little curvature, and a phase tilts it."""
    x = np.arange(40) / 40
    for tilt in (0.0, change):
        heights = -np.cos(2 * np.pi * x + 0.3) + (1 + change) / 8 * np.cos(4 * np.pi * x + 0.6 + tilt)
        trace = Trace(1e-6 * heights, 1e-3, ends="periodic", unit="m")
        full = surface_of(trace).full_contact_load
        curve = patches.curve(trace, full * (1 - BELOW))
        assert np.all(np.diff(curve.compliance) >= 0)
        found = weier.events(trace, 1e-3 * full, 1.1 * full)
        assert found.mean_pressure[-1] == full
        assert found.patch_count.values[-1] == 0
        # Each birth within the gap is followed by a merger, and the last gaps close at full contact.
        assert np.sum(np.where(found.birth, 1, -1)) == -1


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, -1.0, 0.0])
def test_no_number_of_nodes_or_cells_follows_from_a_float_that_is_none(bad):
    origin, width = np.zeros(2), np.array([0.1, bad])
    for extent in ((origin, np.array([0.2, 0.7]), width), (origin, np.array([0.2, bad]), np.full(2, 0.1))):
        count = segments.count_nodes(*extent, 1.0, 6.0, (7.5, 1.0, 14.0))
        assert np.all((count >= 4) & (count <= segments.MAX_NODES))
        series = make_series(np.ones(1), [1], np.zeros(1), 1.0)
        assert inequalities._first_points(extent, 1.0, series.crest_position, series.local)[0].size < 100
        guess = stages.ContactProblem(series, 0.1, CONTACTS)
        if not (np.isfinite(bad) and bad > 0):
            broken = segments.make_segments(np.zeros(2, int), *extent, np.zeros(2, int))
            with pytest.raises(ConvergenceError, match="overlap"):
                stages.make_guess(guess, broken, 1e-10)
