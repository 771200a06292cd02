"""Few contacts by a dense matrix: gaps of rounding size, missing contacts, and what is refused."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import ConvergenceError, Profile
from weier.methods import patches
from weier.methods.patches import newton
from weier.methods.patches.fields import complementary_residuals
from weier.methods.patches.inequalities import minima_outside
from weier.methods.patches.newton import on_few_nodes, solve_on_segments
from weier.methods.patches.segments import segment_strengths
from weier.methods.patches.start import contacts_guess
from weier.methods.patches.surface import nearest_crests, surface_of


@pytest.mark.parametrize("below", [0.0, 1e-13, 1e-12, 1e-11])
def test_a_gap_of_rounding_size_is_closed(below):
    """A merger of 2 contacts: the last gap between them is 4e-8 wide, and its tension 1e-12 of the load."""
    profile, merger = Profile(1.5, 3, 3, (0.0, 1.0, 2.0)), 4.355780741819659
    around = patches.curve(profile, [merger * (1 - 1e-8), merger * (1 - below), merger * (1 + 1e-8)])
    assert around.patch_count[[0, 2]].tolist() == [2, 1]
    assert around.residual.max() < 1e-10
    assert around.compliance[0] < around.compliance[1] < around.compliance[2]
    assert around.resistance[0] > around.resistance[1] > around.resistance[2]
    assert around.resistance[1] == pytest.approx(around.resistance[0], rel=1e-6)


def test_contacts_that_nearly_merge_need_no_sums():
    """A gap is 60 times narrower than both contacts beside it: the first two corrections are of one size."""
    profile = Profile(1.25, 5, 4, (0.0, 1.0, 2.0, 3.0))
    surface, state = surface_of(profile), patches.solve_load(profile, 0.40401).state
    again, _ = newton.solve_few_contacts(surface, on_few_nodes(state, surface.heights), 1e-10)
    assert again.residual < 1e-10


def test_a_resistance_beside_a_merger_takes_more_corrections():
    """Two of them are of one size; the value is that of a dense solution on all nodes."""
    phases = 4.574169531099157, 4.748128995525145, 0.2278665173120248
    profile, load = Profile(1.0693689688036165, 8, 3, phases), 0.2503344663826191
    surface, before = surface_of(profile), patches.solve_load(profile, load * (1 - 1e-7)).state
    start = on_few_nodes(before, surface.series(before.dual))._replace(load=load)
    state, _ = newton.solve_few_contacts(surface, start, 1e-12)
    assert abs(state.resistance - 1.71034873840) < 1e-10
    curve = patches.curve(profile, load)  # for which the gap may count as a crack
    assert abs(curve.resistance - 1.71034873840) < curve.resistance_error < 1e-7


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


@pytest.mark.parametrize(
    ("profile", "load"), [(THREE_WAVES, 0.4), (THREE_WAVES, 2.0), (Profile(1.25, 5, 4, 1.0), 0.6)]
)
def test_the_resistance_falls_as_edges_move_out(profile, load):
    """By 2 pi^2 B^2/L for each unit of length, where an edge moves at the speed 2 B/A: few contacts, gaps, many."""
    before, here, after = patches.solve_loads(profile, load * (1 + np.array([-1e-4, 0, 1e-4])))
    expected = (after.state.resistance - before.state.resistance) / (after.mean_pressure - before.mean_pressure)
    B, strength = here.state.tangent_strength, np.abs(segment_strengths(here.state))
    assert -4 * np.pi**2 / profile.period * np.sum(B**3 / strength) == pytest.approx(expected, rel=1e-5)
    speed = (after.edges - before.edges) / (after.mean_pressure - before.mean_pressure) * [-1, 1]
    np.testing.assert_allclose(np.sort(speed.ravel()), np.sort((2 * B / strength).ravel()), rtol=1e-4)


@pytest.mark.parametrize("above", [1e-2, 1e-4, 1e-6])
def test_a_shallow_missing_contact_is_seen(above):
    """Contacts from below a birth, pressed beyond it: the overlap is 1e-6 to 1e-2 of what it soon would be."""
    events = patches.events(THREE_WAVES, 0.3, 1.0)
    born = events.mean_pressure[events.birth][0]
    surface, before = surface_of(THREE_WAVES), patches.solve_load(THREE_WAVES, born * (1 - 1e-7)).state
    assert not before.dual
    series, limit = surface.heights, 1e-10 * before.approach
    assert np.all(minima_outside(before, series, 0.0)["value"] >= -limit)
    start = on_few_nodes(before, surface.heights)._replace(load=born * (1 + above))
    beyond, *_ = solve_on_segments(surface, start, 1e-10)
    x = np.linspace(-1, 1, 2001) * 10 * above**0.5 / THREE_WAVES.waves_per_period[-1]
    x = events.x[events.birth][0] + x[np.abs(x) < 0.2 / THREE_WAVES.waves_per_period[-1]]
    lowest = complementary_residuals(beyond, series, *nearest_crests(series, x)).min()
    assert lowest < -limit
    assert minima_outside(beyond, series, 0.0)["value"].min() == pytest.approx(lowest, rel=1e-3)


def test_a_guess_with_the_wrong_contacts_is_refused():
    contacts = patches.solve_load(THREE_WAVES, 0.5)
    assert not contacts.state.dual
    assert contacts.centre.size > 2
    force = np.full(contacts.centre.size - 1, 0.5 / (contacts.centre.size - 1))
    guess = contacts_guess(contacts.surface, 0.5, np.stack([contacts.centre[1:], contacts.half_width[1:], force]))
    with pytest.raises(ConvergenceError, match=r"another set of contacts|Newton's method fails"):
        newton.solve_few_contacts(contacts.surface, guess, 1e-10)
