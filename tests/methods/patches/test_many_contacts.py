"""Many contacts without a dense matrix: against the reference values, the dense matrix and bad starts."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from tests.reference import REFERENCES
from weier import ConvergenceError, Profile
from weier.kernels.blas import one_thread
from weier.methods import bem, patches
from weier.methods.patches import many_contacts
from weier.methods.patches.many_contacts import solve_if_many, solve_many_contacts
from weier.methods.patches.surface import surface_of

FOUR_WAVES = Profile(1.25, 5, 4, (0.0, 1.0, 2.0, 3.0))


def edges_of(state):
    segments = state.segments
    centre = segments.origin + segments.centre
    return centre - segments.half_width, centre + segments.half_width


@one_thread
@pytest.mark.parametrize("reference", REFERENCES, ids=str)
def test_reference_values(reference):
    surface = surface_of(reference.profile)
    for row in np.flatnonzero(reference.patches > 2):
        state, _ = solve_many_contacts(reference.profile, surface, reference.mean_pressure[row], 1e-10)
        compliance = reference.profile.total_amplitude - surface.heights.maximum + state.approach
        assert compliance == pytest.approx(reference.compliance[row], abs=1e-10)  # the digits of the reference values
        assert state.sensitivity[-1] == pytest.approx(reference.resistance[row], rel=1e-9)
        assert state.segments.centre.size == reference.patches[row]
        width = 2 * state.segments.half_width.sum() / surface.heights.period
        assert width == pytest.approx(reference.contact_fraction[row], abs=2e-10)
        assert state.residual < 1e-11


@one_thread
def test_both_solvers_agree(monkeypatch):
    loads = np.array([0.3, 2.0, 4.0])
    fast = patches.curve(FOUR_WAVES, loads)
    assert np.any(fast.patch_count > many_contacts.MIN_CONTACTS)
    monkeypatch.setattr(many_contacts, "MIN_CONTACTS", np.inf)
    dense = patches.curve(FOUR_WAVES, loads)
    monkeypatch.setattr(many_contacts, "MIN_CONTACTS", 2)
    all_fast = patches.curve(FOUR_WAVES, loads)
    for curve in (fast, all_fast):
        np.testing.assert_allclose(curve.compliance, dense.compliance, rtol=0, atol=1e-12)
        np.testing.assert_allclose(curve.resistance, dense.resistance, rtol=1e-8)  # what its own refinement moves
        np.testing.assert_allclose(curve.contact_edge, dense.contact_edge, atol=1e-9)
        np.testing.assert_array_equal(curve.patch_count, dense.patch_count)


@one_thread
def test_more_contacts_than_a_dense_matrix_holds():
    profile = Profile(1.25, 5, 6, np.arange(6.0))
    curve = patches.curve(profile, [2.0])
    assert curve.patch_count[0] == 1165  # the same from the edges of boundary elements, and from any start below
    assert curve.residual[0] < 1e-11
    finer = patches.curve(profile, [2.0], tolerance=1e-12)
    assert finer.compliance[0] == pytest.approx(curve.compliance[0], abs=1e-12)
    elements = bem.curve(profile, [2.0], points=16 * 5**5, tolerance=1e-8, resistance=False)
    # 3.3 g_0/(points a wave)^2 for each of the waves in turn; the finest has the amplitude 2e-3.
    assert curve.compliance[0] == pytest.approx(elements.compliance[0], abs=1e-4)


@one_thread
@pytest.mark.parametrize("fault", ["missing", "spurious", "merged", "cut", "shifted"])
def test_bad_starts_lead_to_the_same_contacts(fault):
    surface, load = surface_of(THREE_WAVES), 0.5
    state, _ = solve_many_contacts(THREE_WAVES, surface, load, 1e-10)
    left, right = edges_of(state)
    if fault == "missing":
        left, right = left[::2], right[::2]
    elif fault == "spurious":
        middle = 0.5 * (right[:-1] + left[1:])
        left, right = np.append(left, middle - 1e-3), np.append(right, middle + 1e-3)
    elif fault == "merged":
        left, right = np.delete(left, [1, 2]), np.delete(right, [0, 1])
    elif fault == "cut":
        middle, width = 0.5 * (left + right), right - left
        left, right = np.append(left, middle + 0.05 * width), np.append(middle - 0.05 * width, right)
    else:
        gap = np.append(left[1:], left[0] + 1) - right
        left, right = left + 0.3 * gap, right + 0.3 * gap
    again, _ = solve_many_contacts(THREE_WAVES, surface, load, 1e-10, (left, right))
    assert again.approach == pytest.approx(state.approach, abs=1e-12)
    np.testing.assert_allclose(np.sort(edges_of(again)[0] % 1), np.sort(edges_of(state)[0] % 1), atol=1e-9)


def test_near_full_contact_is_left_to_the_gaps():
    surface = surface_of(FOUR_WAVES)
    load = 0.999 * surface.full_contact_load
    with pytest.raises(ConvergenceError):
        solve_many_contacts(FOUR_WAVES, surface, load, 1e-10)
    assert solve_if_many(FOUR_WAVES, surface, load, 1e-10) is None
    assert patches.curve(FOUR_WAVES, [load]).contact_fraction[0] > 0.99


def test_an_unresolved_pressure_is_noticed(monkeypatch):
    surface = surface_of(FOUR_WAVES)
    monkeypatch.setattr(many_contacts, "_gaps_by_direct_sums", lambda *_: np.array([1e-7]))
    with pytest.raises(ConvergenceError, match="violate their conditions"):
        solve_many_contacts(FOUR_WAVES, surface, 0.3, 1e-10)
