"""Punches and cracks with given edges: closed forms, steps, and the expansions of their densities."""

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval

from tests.methods.patches.westergaard_states import KINDS
from weier.kernels.blas import one_thread
from weier.methods.patches.given_edges import (
    displacement,
    expansion,
    make_punches,
    moved_expansion,
    regular_part,
    solve_forces_on_contacts,
    transfer_forces,
    vanishing_at_edges,
)
from weier.methods.patches.segments import make_segments


def punches_at(centre, half_width, nodes, period, dual=False, most=None):
    none = np.zeros(centre.size)
    segments = make_segments(none.astype(int), none, centre, half_width, np.full(centre.size, nodes))
    return make_punches(segments, period, KINDS[dual], most)


def random_punches(count, nodes, dual=False):
    rng = np.random.default_rng(count)
    centre = (np.arange(count) + 0.5 * rng.random(count)) / count
    return punches_at(centre, rng.uniform(0.02, 0.24, count) / count, nodes, 1.0, dual, most=0)


@pytest.mark.parametrize("most", [0, None])
@pytest.mark.parametrize("fraction", [1e-3, 0.1, 0.5, 0.9])
def test_one_flat_punch_a_period(fraction, period, most):
    """By conjugate gradients with fast sums, and directly."""
    punches = punches_at(np.array([0.6]), np.array([0.5 * fraction * period]), 60, period, most=most)
    none = np.zeros(60)
    solved = solve_forces_on_contacts(punches, none, 1 / period, 0.0, 1e-12)
    assert -solved.plane == pytest.approx(-2 * np.log(np.sin(np.pi / 2 * fraction)), rel=1e-12, abs=0)
    # The pressure is cos(pi y/L)/sqrt(sin^2(pi r/L) - sin^2(pi y/L)) per load, with the mean 1 over the period.
    sine, y = np.sin(np.pi / 2 * fraction), np.pi / period * (punches.offset)
    t = (punches.offset) / punches.segments.half_width
    singular = np.cos(y) / np.sqrt((sine - np.sin(y)) * (sine + np.sin(y))) * np.sqrt((1 - t) * (1 + t)) / period
    np.testing.assert_allclose(solved.force, np.pi / 60 * punches.segments.half_width * singular, rtol=1e-9)


@pytest.mark.parametrize("most", [0, None])
@pytest.mark.parametrize("fraction", [1e-3, 0.1, 0.5, 0.9])
def test_one_crack_a_period(fraction, period, most):
    """By conjugate gradients with fast sums, and directly."""
    cracks = punches_at(np.array([0.6]), np.array([0.5 * fraction * period]), 60, period, True, most)
    solved = solve_forces_on_contacts(cracks, np.ones(60), 1.0, 0.0, 1e-13)
    # Koiter's row of cracks: w = 2 L arcosh(cos(pi y/L)/cos(pi a/L)) under unit tension, where A^-1 is |k|.
    y, sine = np.pi / period * (cracks.offset), np.sin(np.pi / 2 * fraction)
    ratio = np.sqrt((sine - np.sin(y)) * (sine + np.sin(y))) / np.cos(np.pi / 2 * fraction)
    gap = 2 * period * np.arcsinh(ratio)
    weight = np.pi / 61 * np.sin(np.arange(60, 0, -1) * np.pi / 61) * cracks.segments.half_width
    np.testing.assert_allclose(solved.force, weight * gap, rtol=1e-9)
    assert solved.plane == pytest.approx(-period * np.log1p(-(sine**2)), rel=1e-12, abs=0)


@one_thread
@pytest.mark.parametrize("count", [30, 1000])
def test_steps_do_not_grow_with_the_contacts_or_gaps(count, dual):
    punches, none = random_punches(count, 8, dual), np.zeros(8 * count)
    tension = none + dual
    solved = solve_forces_on_contacts(punches, tension, 1.0, 0.0, 1e-10)
    fresh = displacement(punches, solved.force) - tension
    assert solved.steps < 25
    if dual:
        assert np.abs(fresh).max() * 2 * punches.segments.half_width.min() < 1e-9 * solved.plane
    else:
        assert np.ptp(fresh) < 1e-8 * np.abs(fresh).max()
        assert solved.force.sum() == pytest.approx(1, rel=1e-12, abs=0)


@one_thread
def test_direct_and_iterative_solutions_agree(period, dual):
    """On segments whose positions are counted from different origins."""
    rng, count = np.random.default_rng(3), np.array([8, 5, 11, 6])
    centre = np.array([0.1, 0.35, 0.62, 0.85]) * period
    origin = rng.choice(centre, 4)
    half_width = np.array([0.03, 0.1, 0.05, 0.02]) * period
    segments = make_segments(np.zeros(4, int), origin, centre - origin, half_width, count)
    x = np.repeat(centre, count)
    solved = []
    for most in (None, 0):
        punches = make_punches(segments, period, KINDS[dual], most)
        forcing = np.cos(2 * np.pi / period * (x + punches.offset)) + dual
        solved.append(solve_forces_on_contacts(punches, forcing, 0.7, 1e-13))
    direct, iterative = solved
    np.testing.assert_allclose(direct.force, iterative.force, atol=1e-11 * np.abs(direct.force).max())
    assert direct.plane == pytest.approx(iterative.plane, rel=1e-10, abs=0)
    fields = displacement(punches, direct.force) - forcing
    assert np.ptp(fields) < 1e-9 * np.abs(forcing).max()
    assert dual or direct.force.sum() == pytest.approx(0.7 * period, rel=1e-12, abs=0)


def polynomials(count, seed=0):
    """Coefficients in U_k of one polynomial a segment, whose last two are 0, and (1-t^2) times it in T_k."""
    a = np.concatenate([[*np.random.default_rng(seed + size).normal(size=size - 2), 0, 0] for size in count])
    first, b = np.append(0, np.cumsum(count)), np.zeros(a.size)
    for j in range(len(count)):
        for k in range(count[j] - 2):  # (1-t^2) U_k = (T_k - T_(k+2))/2
            b[first[j] + k] += 0.5 * a[first[j] + k]
            b[first[j] + k + 2] -= 0.5 * a[first[j] + k]
    return first, a, b


def test_the_regular_part_of_an_expansion_is_what_is_left_but_for_a_straight_line():
    first, a, b = polynomials([5, 12, 7])
    b[first[:-1]] += [1.0, 2.0, 3.0]
    b[first[:-1] + 1] -= 0.7
    np.testing.assert_allclose(regular_part(first, b), a, atol=1e-14)


def test_a_density_is_moved_with_its_segment():
    """To first order, where the place of a point in its segment changes by (shift + t growth)/r."""
    first, a, b = polynomials([6, 11])
    r, shift, growth = np.array([0.3, 2.0]), np.array([0.2, -0.1]), np.array([-0.3, 0.7])
    moved, regular = moved_expansion(first, r, b, a, shift, growth)
    np.testing.assert_array_equal(regular, regular_part(first, moved))
    t = np.linspace(-0.99, 0.99, 30)
    for j in range(2):
        here = slice(first[j], first[j + 1])
        density = chebval(t, b[here]) / np.sqrt(1 - t**2)
        step = 1e-6 * (shift[j] + t * growth[j]) / r[j]
        there = chebval(t + step, b[here]) / np.sqrt(1 - (t + step) ** 2)
        change = chebval(t, moved[here] - b[here]) / np.sqrt(1 - t**2)
        np.testing.assert_allclose(change, (there - density) / 1e-6, atol=2e-4 * np.abs(change).max())


@pytest.mark.parametrize("power", [0, 2])
def test_what_is_singular_at_edges_is_spread_over_the_coefficients(power):
    """In proportion to k^2 or evenly, of each parity, and the force of each segment stays."""
    first, _, b = polynomials([6, 11])
    rng = np.random.default_rng(1)
    off = b + 1e-6 * rng.normal(size=b.size)
    changed, regular = vanishing_at_edges(first, off, power)
    np.testing.assert_array_equal(regular, regular_part(first, changed))
    for j in range(2):
        here = slice(first[j], first[j + 1])
        k, change = np.arange(first[j + 1] - first[j]), (changed - off)[here]
        assert change[0] == 0
        assert abs(changed[here].sum()) < 1e-15
        assert abs((changed[here] * (-1.0) ** k).sum()) < 1e-15
        for parity in (2, 1):
            part = change[parity::2] / k[parity::2] ** power
            np.testing.assert_allclose(part, part[0], rtol=1e-5, atol=1e-15)


def test_forces_come_back_from_their_expansion(dual, period):
    """And an expansion on other nodes has the same values; a new segment has no forces."""
    centre, half_width = np.array([0.2, 0.6]) * period, np.array([0.1, 0.2]) * period
    punches = punches_at(centre, half_width, 10, period, dual, most=0)
    force = np.random.default_rng(2).normal(size=20)
    if dual:  # of 10 nodes, U_0 ... U_9 and so T_1 ... T_10, of which the last has no place among 10 coefficients
        force = transfer_forces(punches.segments, expansion(punches, force), np.arange(2), punches)
    b = expansion(punches, force)
    again = transfer_forces(punches.segments, b, np.arange(2), punches)
    np.testing.assert_allclose(again, force, rtol=1e-11, atol=1e-13)
    finer = punches_at(centre, half_width, 16, period, dual, most=0)
    of_finer = expansion(finer, transfer_forces(punches.segments, b, np.array([1, -1]), finer))
    np.testing.assert_allclose(of_finer[:10], b[10:], atol=1e-11 * np.abs(b).max())
    assert not np.any(of_finer[16:])
