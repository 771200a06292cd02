"""Nested grids: the waves that they carry, and the pressure that a new wave starts from."""

import numpy as np
import pytest

from tests import westergaard as fields
from tests.profiles import THREE_WAVES
from weier import Profile
from weier.methods.bem import active_set
from weier.methods.bem.grids import add_wave, nested_grids
from weier.theory.halfplane import eigenvalues

SEVEN_WAVES = Profile(1.25, 5, 7, tuple(range(7)))


def test_a_wave_joins_on_the_first_grid_that_shows_it():
    grids = nested_grids(SEVEN_WAVES, 2**18, 1e-8)
    assert [grid.height.size for grid in grids] == [2**n for n in range(7, 19)]
    shown = [[k for k in SEVEN_WAVES.waves_per_period if size >= 8 * k] for size in 2 ** np.arange(7, 19)]
    joined = np.cumsum([grid.waves_per_period.size for grid in grids])
    assert joined.tolist() == [len(waves) for waves in [*shown[:-1], SEVEN_WAVES.waves_per_period]]
    assert grids[0].height == pytest.approx(Profile(1.25, 5, 2, (0, 1)).sampled_height(128), abs=1e-14)


@pytest.mark.parametrize("xi", [0.05, 0.7, 1.0, 3.0])
def test_a_new_wave_starts_from_westergaards_pressure(xi):
    points, (grid,) = 3000, nested_grids(THREE_WAVES, 129, 1e-8)
    full_contact_pressure = grid.full_contact_pressure[2]
    pressure = np.full(points, xi * full_contact_pressure)
    add_wave(2, grid, pressure, np.empty(points))
    x = 25 * np.arange(points) / points + 2.0 / (2 * np.pi)
    assert pressure == pytest.approx(full_contact_pressure * fields.pressure(x, xi), abs=1e-12)
    # The trapezoidal rule on 120 points a wave misses the roots at the edges by O(1/120^1.5).
    assert pressure.mean() == pytest.approx(xi * full_contact_pressure, rel=120**-1.5 / xi)


@pytest.mark.parametrize("points", [4096, 4095, 2187])
def test_any_number_of_nodes_has_coarser_grids(points):
    """And then takes no more work than a power of two: 35 pairs a load on 4095 nodes without them."""
    nodes = np.array([grid.height.size for grid in nested_grids(THREE_WAVES, points, 1e-8)])
    assert nodes[-1] == points
    assert 128 <= nodes[0] < 256
    assert np.all(np.diff(nodes) >= 0.45 * nodes[1:])
    solver = active_set.NestedSolver(THREE_WAVES, points, 1e-8)
    assert np.mean([solver.solve_discrete(load, False).work for load in np.geomspace(1e-3, 2, 40)]) < 25


def test_thousands_of_contacts_meet_the_contact_conditions():
    """Checked with NumPy's own transform, which has only the eigenvalues in common with that of the solver."""
    points, load = 2**17, 1.0
    found = active_set.NestedSolver(SEVEN_WAVES, points, 1e-8).solve_discrete(load, False)
    sunk = np.fft.irfft(eigenvalues(points) * np.fft.rfft(found.pressure))
    gap = sunk - SEVEN_WAVES.sampled_height(points)
    gap -= gap[found.pressure > 0].mean()
    assert found.pressure.min() >= 0
    assert found.pressure.mean() == pytest.approx(load, rel=1e-12)
    assert gap.min() >= -2e-8
    assert np.minimum(found.pressure, gap).max() <= 2e-8
    begins = (found.pressure > 0) & (np.roll(found.pressure, 1) == 0)
    assert begins.sum() > 1000
