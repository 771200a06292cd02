"""Few contacts by a dense matrix: its derivatives, convergence, both problems as one, and what is refused."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import ConvergenceError, Profile
from weier.methods import patches
from weier.methods.patches import newton
from weier.methods.patches.fields import ContactState, complementary_residuals
from weier.methods.patches.inequalities import _cells_of, doubtful_cells, minima_outside
from weier.methods.patches.newton import (
    assemble,
    change_nodes,
    newton_iteration,
    on_few_nodes,
    own_density,
    solve_on_segments,
)
from weier.methods.patches.segments import Iterate, make_segments, move_segments
from weier.methods.patches.start import contacts_guess
from weier.methods.patches.surface import Surface, nearest_crests, surface_of


def solved_state(load: float, tolerance: float) -> tuple[Surface, ContactState]:
    surface, state = surface_of(THREE_WAVES), patches.solve_loads(THREE_WAVES, load, tolerance)[0].state
    assert state is not None
    return surface, state


@pytest.mark.parametrize("dual", [False, True])
def test_jacobian_is_the_derivative(dual):
    series, load = surface_of(Profile(1.4, "3/2", 3, (0.0, 1.0, 2.0))).series(dual), 1.3
    crest, centre, r = np.array([0, 2]), np.array([0.02, -0.03]), np.array([0.11, 0.2])
    segments = make_segments(crest, series.crest_position[crest], centre, r, np.array([4, 6]), series.period)
    unknowns = np.random.default_rng(1).normal(size=segments.node.size + 5)
    unknowns[-5:-1] = 0

    def equations(u, p=load):
        half_width = r * (1 + u[-3:-1])
        moved = move_segments(segments, centre + r * u[-5:-3], half_width, series.period)
        system = assemble(Iterate(dual, moved, u[:-5], u[-1]), series, p)
        if not dual:  # the equations of height and of load are divided by half-widths: undo that
            for each in (system.residual, system.by_load, system.matrix.T):
                each[-3:-1] = (each[-3:-1].T * half_width).T
                each[-1] *= half_width.max()
        return system

    system, step = equations(unknowns), 1e-6
    for row in range(unknowns.size):
        change = step * np.eye(unknowns.size)[row]
        slope = (equations(unknowns + change).residual - equations(unknowns - change).residual) / (2 * step)
        np.testing.assert_allclose(system.matrix[row], slope, atol=1e-6 * (1 + np.abs(slope).max()))
    slope = (equations(unknowns, load + step).residual - equations(unknowns, load - step).residual) / (2 * step)
    np.testing.assert_allclose(system.by_load, slope, atol=1e-6 * (1 + np.abs(slope).max()))


@pytest.mark.parametrize(("load", "counts"), [(0.05, range(4, 13)), (0.7, range(12, 29, 2))])
def test_convergence_is_exponential_in_nodes(load, counts):
    surface, state = solved_state(load, 1e-12)
    series, errors = surface.series(state.dual), []
    for count in counts:
        guess = change_nodes(state.iterate, np.full(state.segments.centre.size, count), series.period)
        fewer, _, _ = newton_iteration(guess, series, load, 1e-12)
        errors.append(abs(fewer.approach / state.approach - 1) + 1e-16)
    rate = -np.polyfit(counts, np.log(errors), 1)[0]
    print(f"load {load}: error falls {np.exp(rate):.1f} times a node; {errors[0]:.0e} to {errors[-1]:.0e}")
    assert rate > 0.5
    assert errors[-1] < 1e-9


@pytest.mark.parametrize("load", [0.05, 0.7, 2.5])
def test_few_nodes_correct_many_as_one_large_matrix_would(load):
    """A matrix that knows the slow modes only solves the equations on many nodes as one that knows all modes does."""
    surface, state = solved_state(load, 1e-10)
    series = surface.series(state.dual)
    dense, _, _ = newton_iteration(state.iterate, series, load, 1e-12)
    assert state.approach == pytest.approx(dense.approach, rel=1e-11)
    np.testing.assert_allclose(state.segments.half_width, dense.segments.half_width, rtol=1e-9)
    system = assemble(dense, series, load)
    sensitivity = np.linalg.solve(system.matrix.T, -system.by_load)
    assert state.sensitivity[-1] == pytest.approx(sensitivity[-1], rel=1e-9)
    np.testing.assert_allclose(state.sensitivity, sensitivity, atol=1e-6 * np.abs(sensitivity).max())


@pytest.mark.parametrize("load", [0.3, 3.0])
def test_edges_alone_are_enough_to_start_from(load):
    """Contacts a little off, with the forces that they carry: Newton's method on few nodes takes a few steps."""
    surface, solution = surface_of(THREE_WAVES), patches.solve_load(THREE_WAVES, load)
    force = np.full(solution.centre.size, load / solution.centre.size)
    guess = contacts_guess(surface, solution.centre, 1.01 * solution.half_width, force, 1e-10)
    series = surface.series(guess.dual)
    _, _, steps = newton_iteration(own_density(guess, series, load), series, load, 1e-3)
    assert steps <= 4
    state, _ = solve_on_segments(surface, own_density(guess, series, load), load, 1e-10)
    assert state.sensitivity[-1] == pytest.approx(patches.curve(THREE_WAVES, load).resistance[0], rel=1e-9)


def test_contacts_and_gaps_are_one_solution():
    """The two problems, for pressure in contacts and for slope in gaps, have nothing but the profile in common."""
    load = 2.5
    surface, dual = solved_state(load, 1e-10)
    assert dual.dual
    gaps = patches.solve_load(THREE_WAVES, load)
    heights, order = surface.heights, np.argsort(gaps.centre % 1)
    centre, r = gaps.centre[order] % 1, 0.999 * gaps.half_width[order]
    crest, y = nearest_crests(heights, centre)
    segments = make_segments(crest, centre - y, y, r, np.full(crest.size, 80), 1.0)
    x = (np.repeat(centre, 80) + np.repeat(r, 80) * segments.node).reshape(-1)
    guess = Iterate(False, segments, gaps.pressure(x) / np.sqrt(1 - segments.node**2), 0.0)
    primal, _, _ = newton_iteration(guess, heights, load, 1e-12)
    assert primal.approach == pytest.approx(heights.maximum + dual.approach, abs=1e-10)
    system = assemble(primal, heights, load)
    resistance = np.linalg.solve(system.matrix.T, -system.by_load)[-1]
    assert resistance == pytest.approx(dual.sensitivity[-1], rel=1e-8)


@pytest.mark.parametrize("below", [0.0, 1e-13, 1e-12, 1e-11])
def test_a_gap_of_rounding_size_is_closed(below):
    """A merger of 2 contacts: the last gap between them is 4e-8 wide, and its tension 1e-12 of the load."""
    profile, merger = Profile(1.5, 3, 3, (0.0, 1.0, 2.0)), 4.355780741819659
    around = patches.curve(profile, [merger * (1 - 1e-8), merger * (1 - below), merger * (1 + 1e-8)])
    assert around.patch_count[0] == 2
    assert around.patch_count[2] == 1
    assert around.residual.max() < 1e-10
    assert around.compliance[0] < around.compliance[1] < around.compliance[2]
    assert around.resistance[0] > around.resistance[1] > around.resistance[2]
    assert around.resistance[1] == pytest.approx(around.resistance[0], rel=1e-6)


@pytest.mark.parametrize("fault", ["unknowns", "residual", "inequalities"])
def test_what_a_dense_matrix_does_not_solve_is_left_to_sums(fault, monkeypatch):
    expected = patches.curve(THREE_WAVES, 0.5)
    if fault == "unknowns":
        monkeypatch.setattr(newton, "MAX_UNKNOWNS", 20)
    elif fault == "residual":
        monkeypatch.setattr(newton, "contact_residual", lambda *_: np.array([1e-3]))
    else:
        monkeypatch.setattr(newton, "MIN_OVERLAP", -np.inf)
        monkeypatch.setattr(newton, "OVERLAP_FACTOR", -np.inf)
    curve = patches.curve(THREE_WAVES, 0.5)
    assert curve.work != expected.work
    assert curve.compliance == pytest.approx(expected.compliance, abs=1e-12)
    assert curve.resistance == pytest.approx(expected.resistance, rel=1e-9)


@pytest.mark.parametrize("above", [1e-2, 1e-4, 1e-6])
def test_a_shallow_missing_contact_is_seen(above):
    """Contacts from below a birth, pressed beyond it: the overlap is 1e-6 to 1e-2 of what it soon would be."""
    events = patches.events(THREE_WAVES, 0.3, 1.0)
    born = events.mean_pressure[events.birth][0]
    surface, before = surface_of(THREE_WAVES), patches.solve_load(THREE_WAVES, born * (1 - 1e-7)).state
    assert not before.dual
    series, limit = surface.heights, 1e-10 * before.approach
    assert minima_outside(before, series).lowest >= -limit
    beyond, _ = solve_on_segments(surface, on_few_nodes(before.iterate, surface.heights), born * (1 + above), 1e-10)
    x = np.linspace(-1, 1, 2001) * 10 * above**0.5 / THREE_WAVES.waves_per_period[-1]
    x = events.x[events.birth][0] + x[np.abs(x) < 0.2 / THREE_WAVES.waves_per_period[-1]]
    lowest = complementary_residuals(beyond, series, *nearest_crests(series, x)).min()
    assert lowest < -limit
    assert minima_outside(beyond, series).lowest == pytest.approx(lowest, rel=1e-3)


def test_a_guess_with_the_wrong_contacts_is_refused():
    surface, state = solved_state(0.5, 1e-10)
    contacts = patches.solve_load(THREE_WAVES, 0.5)
    assert not state.dual
    assert contacts.centre.size > 2
    force = np.full(contacts.centre.size - 1, 0.5 / (contacts.centre.size - 1))
    guess = contacts_guess(surface, contacts.centre[1:], contacts.half_width[1:], force, 1e-10)
    with pytest.raises(ConvergenceError, match=r"another set of contacts|Newton's method fails"):
        newton.solve_few_contacts(surface, guess, 0.5, 1e-10)


def test_a_gap_is_positive_wherever_a_tangent_says_so():
    """Also where a contact is missing, pressed beyond its birth: the cell that it belongs to is doubtful."""
    events = patches.events(THREE_WAVES, 0.3, 1.0)
    born, place = events.mean_pressure[events.birth][0], events.x[events.birth][0]
    surface, before = surface_of(THREE_WAVES), patches.solve_load(THREE_WAVES, born * (1 - 1e-7)).state
    beyond, _ = solve_on_segments(surface, on_few_nodes(before.iterate, surface.heights), born * 1.01, 1e-10)
    heights = surface.heights
    x = np.append((np.arange(4000) + 0.5) * THREE_WAVES.period / 4000, place)
    cell = _cells_of(heights, x)
    above = THREE_WAVES.height(x) - heights.maximum - heights.cell_offset[cell]
    assert above.max() < 1e-12  # no point of a cell is higher than its maximum, but for rounding
    doubtful = doubtful_cells(beyond, heights)
    gap = complementary_residuals(beyond, heights, *nearest_crests(heights, x))
    assert gap[-1] < 0
    assert doubtful[cell[-1]]
    assert np.mean(doubtful) < 0.5
    assert np.all(gap[~doubtful[cell]] > 0)
    light = solved_state(0.003, 1e-10)[1]
    assert np.sum(doubtful_cells(light, heights)) == 1  # the crest that is in contact
