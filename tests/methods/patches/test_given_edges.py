"""Punches and cracks with given edges: closed forms, symmetry, and the inverse of the forces between them."""

import numpy as np
import pytest

from weier.kernels.blas import one_thread
from weier.methods.patches.given_edges import (
    MAX_DENSE,
    RANK_TOLERANCE,
    Bounds,
    displacement,
    expansion,
    forces_of_expansion,
    invert_punches,
    make_punches,
    regular_part,
    solve_forces,
    solve_forces_on_contacts,
)


def random_punches(count, nodes, dual=False):
    rng = np.random.default_rng(count)
    centre = (np.arange(count) + 0.5 * rng.random(count)) / count
    return make_punches(centre, rng.uniform(0.02, 0.24, count) / count, np.full(count, nodes), 1.0, dual)


@pytest.mark.parametrize("share", [1e-3, 0.1, 0.5, 0.9])
def test_one_flat_punch_a_period(share):
    period = 2.0
    punches = make_punches(np.array([0.6]), np.array([0.5 * share * period]), np.array([60]), period)
    none = np.zeros(60)
    solved = solve_forces_on_contacts(punches, none, 1.0, none, Bounds(1e-12, 0.0, 1.0))
    assert -solved.plane == pytest.approx(-2 * np.log(np.sin(np.pi / 2 * share)), rel=1e-12)
    # The pressure is cos(pi y/L)/sqrt(sin^2(pi r/L) - sin^2(pi y/L)) per load, with the mean 1 over the period.
    sine, y = np.sin(np.pi / 2 * share), np.pi / period * (punches.position - 0.6)
    t = (punches.position - 0.6) / punches.half_width
    singular = np.cos(y) / np.sqrt((sine - np.sin(y)) * (sine + np.sin(y))) * np.sqrt((1 - t) * (1 + t)) / period
    np.testing.assert_allclose(solved.force, np.pi / 60 * punches.half_width * singular, rtol=1e-9)


@pytest.mark.parametrize("share", [1e-3, 0.1, 0.5, 0.9])
def test_one_crack_a_period(share):
    period = 2.0
    cracks = make_punches(np.array([0.6]), np.array([0.5 * share * period]), np.array([60]), period, True)
    solved = solve_forces_on_contacts(cracks, np.ones(60), 1.0, np.zeros(60), Bounds(1e-13, 0.0, np.inf))
    # Koiter's row of cracks: w = 2 L arcosh(cos(pi y/L)/cos(pi a/L)) under unit tension, where A^-1 is |k|.
    y, sine = np.pi / period * (cracks.position - 0.6), np.sin(np.pi / 2 * share)
    ratio = np.sqrt((sine - np.sin(y)) * (sine + np.sin(y))) / np.cos(np.pi / 2 * share)
    gap = 2 * period * np.arcsinh(ratio)
    weight = np.pi / 61 * np.sin(np.arange(60, 0, -1) * np.pi / 61) * cracks.half_width
    np.testing.assert_allclose(solved.force, weight * gap, rtol=1e-9)
    assert solved.plane == pytest.approx(-2 * period * np.log(np.cos(np.pi / 2 * share)), rel=1e-12)


@pytest.mark.parametrize("dual", [False, True])
def test_the_influence_is_symmetric_and_positive(dual):
    punches = random_punches(20, 9, dual)
    one, other = np.random.default_rng(3).normal(size=(2, 180))
    if dual:  # nodal forces of smooth gaps, small near the edges
        one, other = (np.tile(punches.groups[0].rule.weight, 20) * each for each in (one, other))
    one, other = one - one.mean(), other - other.mean()
    assert one @ displacement(punches, other) == pytest.approx(other @ displacement(punches, one), rel=1e-11)
    assert one @ displacement(punches, one) > 0


@one_thread
@pytest.mark.parametrize("count", [3, MAX_DENSE, 700])
def test_forces_between_punches(count):
    punches = random_punches(count, 2)
    chord = np.abs(2 * np.sin(np.pi * (punches.centre[:, None] - punches.centre)))
    np.fill_diagonal(chord, np.pi * punches.half_width)
    force = np.random.default_rng(4).normal(size=count)
    inverse = invert_punches(punches.centre, punches.half_width, 1.0)
    # The matrix has a condition number of some 1e3, and each of its halves an error of the tolerance.
    error = solve_forces(inverse, -2 * np.log(chord) @ force) - force
    assert np.abs(error).max() < 1e3 * RANK_TOLERANCE


@one_thread
@pytest.mark.parametrize("count", [30, 1000])
def test_steps_do_not_grow_with_the_gaps(count):
    cracks = random_punches(count, 8, True)
    tension = np.ones(8 * count)
    solved = solve_forces_on_contacts(cracks, tension, 1.0, 0 * tension, Bounds(1e-10, 0.0, np.inf))
    pressure = displacement(cracks, solved.force) - tension
    assert np.abs(pressure).max() * 2 * cracks.half_width.min() < 1e-9 * solved.plane
    assert solved.steps < 25


@one_thread
@pytest.mark.parametrize("count", [30, 1000])
def test_steps_do_not_grow_with_the_contacts(count):
    punches = random_punches(count, 8)
    none = np.zeros(8 * count)
    solved = solve_forces_on_contacts(punches, none, 1.0, none, Bounds(1e-10, 0.0, 1.0))
    height = displacement(punches, solved.force)
    assert np.ptp(height) < 1e-8 * np.abs(height).max()  # flat, on a fresh product
    assert solved.force.sum() == pytest.approx(1, rel=1e-12)
    assert solved.steps < 20


def bounded_expansion(a):
    """Coefficients in T_k of (1-t^2) sum a_k U_k, of which 7 belong to each segment."""
    b = 0.5 * a.reshape(-1, 7)
    b[:, 2:] -= 0.5 * a.reshape(-1, 7)[:, :-2]
    return b.ravel()


@pytest.mark.parametrize("dual", [False, True])
def test_expansions(dual):
    punches = random_punches(3, 7, dual)
    a = np.zeros(21)
    a[[0, 4, 7, 8, 14]] = 1.0, 0.3, 2.0, -0.5, 1.5  # phi of three segments, of degree 4 at most
    if dual:
        a[[0, 4, 7, 8, 11, 14]] = 0.0, 0.0, 0.0, 0.5, -0.2, 0.0  # a gap closes at its far end: only odd ones here
    b = bounded_expansion(a)
    np.testing.assert_allclose(regular_part(punches.first_node, b), a, atol=1e-15)
    force = forces_of_expansion(b.reshape(3, 7), punches.half_width, 7, dual).ravel()
    np.testing.assert_allclose(expansion(punches, force), b, atol=1e-14)
    rule, r = punches.groups[0].rule, punches.half_width
    t = rule.node
    if not dual:
        phi = 1 + 0.3 * (16 * t**4 - 12 * t**2 + 1)
        np.testing.assert_allclose(force[:7], np.pi / 7 * r[0] * (1 - t**2) * phi, rtol=1e-12)
    else:  # dw/dx = t sqrt(1-t^2) for a_1 = 1/2
        b[7:14] = bounded_expansion(np.where(np.arange(21) == 8, 0.5, 0.0))[7:14]
        force = forces_of_expansion(b.reshape(3, 7), r, 7, True)
        np.testing.assert_allclose(force[1], -(r[1] ** 2) / 3 * rule.weight * (1 - t**2), rtol=1e-12)
