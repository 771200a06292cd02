"""Punches and cracks with given edges: closed forms and steps."""

import numpy as np
import pytest

from weier.kernels.blas import one_thread
from weier.methods.patches.given_edges import Bounds, displacement, make_punches, solve_forces_on_contacts
from weier.methods.patches.segments import make_segments


def punches_at(centre, half_width, nodes, period, dual=False, most=None):
    none = np.zeros(centre.size)
    segments = make_segments(none.astype(int), none, centre, half_width, np.full(centre.size, nodes))
    return make_punches(segments, period, dual, most)


def random_punches(count, nodes, dual=False):
    rng = np.random.default_rng(count)
    centre = (np.arange(count) + 0.5 * rng.random(count)) / count
    return punches_at(centre, rng.uniform(0.02, 0.24, count) / count, nodes, 1.0, dual, most=0)


@pytest.mark.parametrize("most", [0, None])
@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
@pytest.mark.parametrize("fraction", [1e-3, 0.1, 0.5, 0.9])
def test_one_flat_punch_a_period(fraction, period, most):
    """By conjugate gradients with fast sums, and directly."""
    punches = punches_at(np.array([0.6]), np.array([0.5 * fraction * period]), 60, period, most=most)
    none = np.zeros(60)
    solved = solve_forces_on_contacts(punches, none, 1 / period, none, Bounds(1e-12, 0.0, 1.0))
    assert -solved.plane == pytest.approx(-2 * np.log(np.sin(np.pi / 2 * fraction)), rel=1e-12)
    # The pressure is cos(pi y/L)/sqrt(sin^2(pi r/L) - sin^2(pi y/L)) per load, with the mean 1 over the period.
    sine, y = np.sin(np.pi / 2 * fraction), np.pi / period * (punches.offset)
    t = (punches.offset) / punches.segments.half_width
    singular = np.cos(y) / np.sqrt((sine - np.sin(y)) * (sine + np.sin(y))) * np.sqrt((1 - t) * (1 + t)) / period
    np.testing.assert_allclose(solved.force, np.pi / 60 * punches.segments.half_width * singular, rtol=1e-9)


@pytest.mark.parametrize("most", [0, None])
@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
@pytest.mark.parametrize("fraction", [1e-3, 0.1, 0.5, 0.9])
def test_one_crack_a_period(fraction, period, most):
    """By conjugate gradients with fast sums, and directly."""
    cracks = punches_at(np.array([0.6]), np.array([0.5 * fraction * period]), 60, period, True, most)
    solved = solve_forces_on_contacts(cracks, np.ones(60), 1.0, np.zeros(60), Bounds(1e-13, 0.0, np.inf))
    # Koiter's row of cracks: w = 2 L arcosh(cos(pi y/L)/cos(pi a/L)) under unit tension, where A^-1 is |k|.
    y, sine = np.pi / period * (cracks.offset), np.sin(np.pi / 2 * fraction)
    ratio = np.sqrt((sine - np.sin(y)) * (sine + np.sin(y))) / np.cos(np.pi / 2 * fraction)
    gap = 2 * period * np.arcsinh(ratio)
    weight = np.pi / 61 * np.sin(np.arange(60, 0, -1) * np.pi / 61) * cracks.segments.half_width
    np.testing.assert_allclose(solved.force, weight * gap, rtol=1e-9)
    assert solved.plane == pytest.approx(-2 * period * np.log(np.cos(np.pi / 2 * fraction)), rel=1e-12)


@one_thread
@pytest.mark.parametrize("count", [30, 1000])
@pytest.mark.parametrize("dual", [False, True])
def test_steps_do_not_grow_with_the_contacts_or_gaps(count, dual):
    punches, none = random_punches(count, 8, dual), np.zeros(8 * count)
    tension = none + dual
    bounds = Bounds(1e-10, 0.0, np.inf if dual else 1.0)
    solved = solve_forces_on_contacts(punches, tension, 1.0, none, bounds)
    fresh = displacement(punches, solved.force) - tension
    assert solved.steps < 25
    if dual:
        assert np.abs(fresh).max() * 2 * punches.segments.half_width.min() < 1e-9 * solved.plane
    else:
        assert np.ptp(fresh) < 1e-8 * np.abs(fresh).max()
        assert solved.force.sum() == pytest.approx(1, rel=1e-12)
