"""Nested grids: the waves that they carry, and the pressure that a new wave starts from."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import Profile
from weier.methods import westergaard
from weier.methods.bem import active_set, curve
from weier.methods.bem.grids import add_harmonic, harmonics_of, nested_grids
from weier.theory.halfplane import eigenvalues

SEVEN_WAVES = Profile(1.25, 5, 7, tuple(range(7)))


def test_a_wave_joins_on_the_first_grid_that_shows_it():
    grids = nested_grids(SEVEN_WAVES, 2**18, 1e-8)
    assert [grid.height.size for grid in grids] == [2**n for n in range(7, 19)]
    for grid in grids[:-1]:
        shown = [k for k in SEVEN_WAVES.waves_per_period if grid.height.size >= 8 * k]
        assert grid.terms == len(shown)
    assert grids[-1].terms == 7
    assert grids[0].height == pytest.approx(Profile(1.25, 5, 2, (0, 1)).sampled_height(128), abs=1e-14)


@pytest.mark.parametrize("xi", [0.05, 0.7, 1.0, 3.0])
def test_a_new_wave_starts_from_westergaards_pressure(xi):
    points, wave = 3000, 2
    harmonics = harmonics_of(THREE_WAVES)
    full_contact_pressure = harmonics.full_contact_pressure[wave]
    pressure = np.full(points, xi * full_contact_pressure)
    add_harmonic(wave, harmonics, pressure, np.empty(points))
    x = 25 * np.arange(points) / points + 2.0 / (2 * np.pi)
    assert pressure == pytest.approx(full_contact_pressure * westergaard.pressure(x, xi), abs=1e-12)
    # The trapezoidal rule on 120 points a wave misses the roots at the edges by O(1/120^1.5).
    assert pressure.mean() == pytest.approx(xi * full_contact_pressure, rel=120**-1.5 / xi)


@pytest.mark.parametrize("points", [4096, 4095, 2187])
def test_any_number_of_nodes_has_coarser_grids(points):
    """And then takes no more work than a power of two: 35 pairs a load on 4095 nodes without them."""
    nodes = np.array([grid.height.size for grid in nested_grids(THREE_WAVES, points, 1e-8)])
    assert nodes[-1] == points
    assert 128 <= nodes[0] < 256
    assert np.all(np.diff(nodes) >= 0.45 * nodes[1:])
    loads, settings = np.geomspace(1e-3, 2, 40), {"max_residual": 1e-8, "with_resistance": False, "staircase": "kept"}
    found = curve(THREE_WAVES, loads, points=points, **settings)
    assert found.work.mean() < 25


def test_thousands_of_contacts_meet_the_contact_conditions(monkeypatch):
    """Checked with NumPy's own transform, which has only the eigenvalues in common with that of the solver.

    They are solved in parts, between which Ctrl-C may come.
    """
    points, load = 2**17, 1.0
    parts, iterate = [], active_set._iterate
    monkeypatch.setattr(active_set, "_iterate", lambda *of: parts.append(of[-2].terms) or iterate(*of))
    found = active_set.NestedSolver(SEVEN_WAVES, points, 1e-8).solve_discrete(load, False)
    sunk = np.fft.irfft(eigenvalues(points) * np.fft.rfft(found.pressure))
    gap = sunk - SEVEN_WAVES.sampled_height(points)
    gap -= gap[found.pressure > 0].mean()
    assert found.pressure.min() >= 0
    assert found.pressure.mean() == pytest.approx(load, rel=1e-12)
    assert gap.min() >= -2e-8
    assert parts.count(7) > 1
    assert np.minimum(found.pressure, gap).max() <= 2e-8
    begins = (found.pressure > 0) & (np.roll(found.pressure, 1) == 0)
    assert begins.sum() > 1000
