"""Boundary elements with their staircase: against Westergaard, reference values, and the paper's dense solver."""

import numpy as np
import pytest

import weier
from tests.dense import dense_curve
from tests.profiles import THREE_WAVES
from tests.reference import REFERENCES
from weier import ConvergenceError, Profile
from weier.methods import bem, westergaard
from weier.methods.bem import active_set


def curve(profile, mean_pressure, **settings):
    """The curve with its staircase, as the paper has it."""
    return bem.curve(profile, mean_pressure, staircase="kept", **settings)


def test_one_wave_is_westergaards():
    """Linear elements leave up to 3.3/N^2 while an edge of contact stands between two nodes: 1.25e-5 at 512."""
    loads = np.geomspace(1e-3, 1.5, 200)
    found = curve(Profile(1.25, 5, 1), loads, points=512)
    error = np.abs(found.compliance - westergaard.compliance(loads))
    print(f"one wave on 512 nodes: largest error {error.max():.2e}, median {np.median(error):.2e}")
    assert error.max() <= 1.25e-5
    assert np.median(error) <= 1e-5
    assert np.all(found.compliance[loads > 1] == pytest.approx(1, abs=1e-12))
    assert np.all(found.resistance[loads > 1] == 0)


@pytest.mark.parametrize("reference", REFERENCES, ids=str)
def test_both_solvers_solve_the_same_discrete_problem(reference):
    points = 32 * reference.profile.waves_per_period[-1] if reference.profile.terms < 4 else 1000
    loads = reference.mean_pressure
    fast = curve(reference.profile, loads, points=points)
    dense = dense_curve(reference.profile, loads, points=points, staircase="kept")
    assert fast.compliance == pytest.approx(dense.compliance, abs=1e-9)
    assert np.all(fast.patch_count == dense.patch_count)
    # The tangent pressure has a residual of 1e-4. The resistance is an energy, whose error is the square of that, and
    # what is known of the staircase to as much as that is about a thousandth of it.
    assert fast.resistance == pytest.approx(dense.resistance, rel=1e-7, abs=1e-10)


def test_points_are_given_for_each_of_the_finest_waves():
    """The finest of gamma = 5/2, m = 3 fits 25 times into the period, which is 4."""
    assert weier.solve(Profile(1.25, "5/2", 3, 1.0), [0.3], "bem", points_per_wave=16).points == 400


def test_there_is_space_for_contact_at_every_other_node():
    solver = active_set.NestedSolver(Profile(1.9, 10, 2), 21, 1e-10)
    contact = solver.solve_discrete(2.3, False).contact
    edges = np.count_nonzero(contact != np.roll(contact, 1))
    assert edges == 20
    assert solver._states[-1].edge.size >= edges + 2


@pytest.mark.parametrize("points", [51, 64])
def test_any_number_of_points_above_two_a_wave_will_do(points):
    loads = np.geomspace(1e-3, 5, 12)
    found, dense = (solve(THREE_WAVES, loads, points, staircase="kept") for solve in (bem.curve, dense_curve))
    assert found.compliance == pytest.approx(dense.compliance, abs=1e-9)
    with pytest.raises(ValueError, match="points must be a whole number, from 51 to 10000000, got 50"):
        bem.curve(THREE_WAVES, loads, 50)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"points_per_wave": 16.5}, "points_per_wave of bem must be a whole number"),
        ({"points_per_wave": 16, "tolerance": 0.1}, "a grid takes tolerance or points_per_wave, and not both"),
        ({"points_per_wave": 2_000_001}, "points must be a whole number, from 1 to 10000000, got 10000005"),
        ({"staircase": "foo"}, "staircase of bem must be"),
    ],
)
def test_bad_grids_are_refused(settings, message):
    with pytest.raises(ValueError, match=message):
        weier.solve(Profile(1.25, 5, 2), [0.1], "bem", **settings)


def test_what_is_not_a_number_is_an_error():
    """max() passes over NaN: a certificate must not. Nor does a load leave any to the next one."""
    solver = active_set.NestedSolver(Profile(1.25, 5, 1), 8, 1e-10)
    solution, height = solver.solve_discrete(0.3, True), solver.grid.height.copy()
    for wrong in (np.nan, np.inf):
        solver.grid.height[3] = wrong
        assert solver.solve_discrete(0.3, False).residual == np.inf
    solver.grid.height[:] = height
    assert solver.solve_discrete(0.3, True).resistance == solution.resistance


def test_a_tolerance_below_rounding_is_an_error_not_a_wrong_curve():
    with pytest.raises(ConvergenceError, match="residual") as caught:
        curve(THREE_WAVES, np.array([1.0]), points=400, max_residual=1e-30)
    assert caught.value.residual > 1e-30


@pytest.mark.parametrize("load", [0.02, 0.4])
def test_a_solution_does_not_depend_on_where_its_parts_end(monkeypatch, load):
    """The guess of each grid is made once, also if a part ends between two grids."""
    found = []
    for part in (active_set.WORK_PER_CALL, 1, 3000):
        monkeypatch.setattr(active_set, "WORK_PER_CALL", part)
        solution = active_set.NestedSolver(THREE_WAVES, 1600, 1e-10).solve_discrete(load, True)
        found.append((solution.plane, solution.work, solution.resistance))
    assert found[0] == found[1] == found[2]


def test_many_loads_are_bounded_in_blocks():
    """The exact slope of one wave lies within the bounds, which no load makes wider."""
    loads = np.geomspace(1e-3, 0.9, 1000)
    found = bem.curve(Profile(1.25, 5, 1), loads, points=32)
    assert np.all(abs(found.resistance - westergaard.resistance(loads)) <= found.resistance_error)
    few = bem.curve(Profile(1.25, 5, 1), loads[::5], points=32)
    assert np.all(found.resistance_error[::5] <= few.resistance_error)
