"""One load: convergence, the agreement of the two problems, and what cannot be solved."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import ConvergenceError, Profile
from weier.methods import patches
from weier.methods.patches import few_contacts
from weier.methods.patches.collocation import NewtonResult, newton_iteration
from weier.methods.patches.few_contacts import solve_on_few_nodes, solve_on_many_nodes, solve_on_segments
from weier.methods.patches.fields import ContactState, complementary_residuals
from weier.methods.patches.inequalities import cell_of, doubtful_cells, lowest_outside
from weier.methods.patches.initial_guess import (
    InitialGuess,
    Intervals,
    contacts_guess,
    refine_density,
    sort_segments,
    transfer_density,
)
from weier.methods.patches.surface import Surface, surface_of


def solved_state(load: float, tolerance: float) -> tuple[Surface, ContactState]:
    surface, state = surface_of(THREE_WAVES), patches.solve_loads(THREE_WAVES, load, tolerance)[0].state
    assert state is not None
    return surface, state


def newton_on(surface: Surface, guess: InitialGuess, load: float) -> NewtonResult:
    """Newton's method with the matrix of all nodes."""
    series = surface.series(guess.dual)
    return newton_iteration(guess.segments, guess.phi, guess.approach, series, load, guess.dual, 1e-12)


@pytest.mark.parametrize(("load", "counts"), [(0.05, range(4, 13)), (0.7, range(12, 29, 2))])
def test_convergence_is_exponential_in_nodes(load, counts):
    surface, state = solved_state(load, 1e-12)
    old, errors = state.segments, []
    for count in counts:
        node_count = np.full(old.centre.size, count)
        guess = transfer_density(surface, state, node_count)
        fewer = newton_on(surface, guess, load)
        errors.append(abs(fewer.approach / state.approach - 1) + 1e-16)
    rate = -np.polyfit(counts, np.log(errors), 1)[0]
    print(f"load {load}: error falls {np.exp(rate):.1f} times a node; {errors[0]:.0e} to {errors[-1]:.0e}")
    assert rate > 0.5
    assert errors[-1] < 1e-9


@pytest.mark.parametrize("load", [0.05, 0.7, 2.5])
def test_few_nodes_correct_many_as_one_large_matrix_would(load):
    """The same equations on the same nodes, by a matrix that knows the slow modes only and by one that knows all."""
    surface, state = solved_state(load, 1e-10)
    guess = InitialGuess(state.dual, state.segments, state.phi, state.approach)
    whole = newton_on(surface, guess, load)
    assert state.approach == pytest.approx(whole.approach, rel=1e-11)
    np.testing.assert_allclose(state.segments.half_width, whole.segments.half_width, rtol=1e-9)
    assert state.sensitivity[-1] == pytest.approx(whole.sensitivity[-1], rel=1e-9)
    scale = np.abs(whole.sensitivity).max()
    np.testing.assert_allclose(state.sensitivity, whole.sensitivity, atol=1e-6 * scale)


@pytest.mark.parametrize("load", [0.3, 3.0])
def test_edges_alone_are_enough_to_start_from(load):
    """Contacts a little off, with the forces that they carry: Newton's method on few nodes takes a few steps."""
    surface, solution = surface_of(THREE_WAVES), patches.solve_load(THREE_WAVES, load)
    force = np.full(solution.centre.size, load / solution.centre.size)
    guess = contacts_guess(surface, solution.centre, 1.01 * solution.half_width, force, 1e-10)
    guess = refine_density(surface, guess, load)
    coarse = solve_on_few_nodes(surface, guess, load)
    assert coarse.steps <= 4
    state, _ = solve_on_many_nodes(surface, coarse, guess.dual, load, 1e-10)
    assert state.sensitivity[-1] == pytest.approx(patches.curve(THREE_WAVES, load).resistance[0], rel=1e-9)


def test_contacts_and_gaps_are_one_solution():
    """The two problems, for pressure in contacts and for slope in gaps, have nothing but the profile in common."""
    load = 2.5
    surface, dual = solved_state(load, 1e-10)
    assert dual.dual
    gaps = patches.solve_load(THREE_WAVES, load)
    heights = surface.heights
    crest = np.array([np.argmin(np.abs((heights.crest_position - x + 0.5) % 1 - 0.5)) for x in gaps.centre])
    centre = (gaps.centre - heights.crest_position[crest] + 0.5) % 1 - 0.5
    counts = np.full(crest.size, 80)
    segments, order = sort_segments(heights, Intervals(crest, centre, gaps.half_width * 0.999), node_count=counts)
    phi = [gaps.pressure(gaps.centre[j] + gaps.half_width[j] * segments.node[:80] * 0.999) for j in order]
    phi = np.concatenate(phi) / np.sqrt(1 - segments.node**2)
    primal = newton_on(surface, InitialGuess(False, segments, phi, 0.0), load)
    assert primal.approach == pytest.approx(heights.maximum + dual.approach, abs=1e-10)
    assert primal.sensitivity[-1] == pytest.approx(dual.sensitivity[-1], rel=1e-8)


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
        monkeypatch.setattr(few_contacts, "MAX_UNKNOWNS", 20)
    elif fault == "residual":
        monkeypatch.setattr(few_contacts, "contact_residual", lambda *_: (0.0, 1e-3, 0.0))
    else:
        monkeypatch.setattr(few_contacts, "check_inequalities", lambda *_: (False, 0.0, 0.0))
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
    assert lowest_outside(before, series, limit) >= 0
    beyond, _ = solve_on_segments(surface, transfer_density(surface, before), born * (1 + above), 1e-10)
    x = np.linspace(-1, 1, 2001) * 10 * above**0.5 / THREE_WAVES.waves_per_period[-1]
    x = events.x[events.birth][0] + x[np.abs(x) < 0.2 / THREE_WAVES.waves_per_period[-1]]
    lowest = complementary_residuals(beyond, series, x).min()
    assert lowest < -limit
    assert lowest_outside(beyond, series, limit) == pytest.approx(lowest, rel=1e-3)


def test_a_guess_with_the_wrong_contacts_is_refused():
    surface, state = solved_state(0.5, 1e-10)
    contacts = patches.solve_load(THREE_WAVES, 0.5)
    assert not state.dual
    assert contacts.centre.size > 2
    force = np.full(contacts.centre.size - 1, 0.5 / (contacts.centre.size - 1))
    guess = contacts_guess(surface, contacts.centre[1:], contacts.half_width[1:], force, 1e-10)
    with pytest.raises(ConvergenceError, match=r"another set of contacts|Newton's method fails"):
        few_contacts.solve_few_contacts(surface, guess, 0.5, 1e-10)


def test_a_gap_is_positive_wherever_a_tangent_says_so():
    """Also where a contact is missing, pressed beyond its birth: the cell that it belongs to is doubtful."""
    events = patches.events(THREE_WAVES, 0.3, 1.0)
    born, place = events.mean_pressure[events.birth][0], events.x[events.birth][0]
    surface, before = surface_of(THREE_WAVES), patches.solve_load(THREE_WAVES, born * (1 - 1e-7)).state
    beyond, _ = solve_on_segments(surface, transfer_density(surface, before), born * 1.01, 1e-10)
    heights = surface.heights
    x = np.append((np.arange(4000) + 0.5) * THREE_WAVES.period / 4000, place)
    cell = np.array([cell_of(heights, position) for position in x])
    above = THREE_WAVES.height(x) - heights.maximum - heights.cell_offset[cell]
    assert above.max() < 1e-12  # no point of a cell is higher than its maximum, but for rounding
    doubtful = doubtful_cells(beyond, heights)
    gap = complementary_residuals(beyond, heights, x)
    assert gap[-1] < 0
    assert doubtful[cell[-1]]
    assert np.mean(doubtful) < 0.5
    assert np.all(gap[~doubtful[cell]] > 0)
    light = solved_state(0.003, 1e-10)[1]
    assert np.sum(doubtful_cells(light, heights)) == 1  # the crest that is in contact
