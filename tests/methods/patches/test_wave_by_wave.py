"""The contacts that the iteration starts from, and one step on their edges."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import ConvergenceError, Profile
from weier.kernels.blas import one_thread
from weier.methods import patches
from weier.methods.patches.edge_iteration import Stage, make_guess, next_guess, take_step
from weier.methods.patches.punches import Bounds, forces_of_expansion, make_punches
from weier.methods.patches.wave_by_wave import force_left_of, wave_by_wave

STAGE = Stage(8.0, 5.0, Bounds(1e-10, 1e-14, 1e-10))


@one_thread
@pytest.mark.parametrize("load", [0.01, 0.3, 0.9])
def test_one_wave_is_westergaard(load):
    left, right = wave_by_wave(Profile(1.5, 3, 1, (0.7,)), load, STAGE)
    assert float(right[0] - left[0]) == pytest.approx(2 / np.pi * np.arcsin(np.sqrt(load)), rel=1e-12)
    assert float(left[0] + right[0]) / 2 % 1 == pytest.approx(1 - 0.7 / (2 * np.pi), rel=1e-12)


@one_thread
@pytest.mark.parametrize("load", [0.03, 0.3, 1.0])
def test_contacts_of_three_waves(load):
    left, right = wave_by_wave(THREE_WAVES, load, STAGE)
    exact = patches.solve_load(THREE_WAVES, load)
    assert abs(left.size - exact.centre.size) <= 2
    covered = np.sum(right - left)
    assert covered == pytest.approx(2 * exact.half_width.sum(), rel=0.2)


def test_full_contact_has_no_edges():
    with pytest.raises(ConvergenceError, match="contact is full"):
        wave_by_wave(Profile(1.5, 3, 1), 1.5, STAGE)


@one_thread
@pytest.mark.parametrize(("load", "error"), [(0.02, 0.5), (0.02, -0.4), (0.99, 0.5), (0.99, -0.4)])
def test_a_small_contact_or_gap_is_right_after_one_step(load, error):
    profile = Profile(1.5, 3, 1)
    contact = np.arcsin(np.sqrt(load)) / np.pi
    half_width = contact * (1 + error) if load < 0.5 else 0.5 - (0.5 - contact) * (1 + error)
    stage = STAGE._replace(base_nodes=150.0)
    step = take_step(
        profile, load, make_guess(profile, np.array([-half_width]), np.array([half_width]), stage), stage
    )
    moved = next_guess(profile, step, stage).half_width[0]
    scale = min(contact, 0.5 - contact)
    # The closed forms are those of a parabola, from which the wave differs by the square of this scale in radians.
    assert abs(moved - contact) < 2 * (np.pi * scale) ** 2 * scale
    assert abs(half_width - contact) > 0.3 * scale


def test_force_between_edges():
    punches = make_punches(np.array([0.2, 0.8]), np.array([0.1, 0.15]), np.array([6, 6]), 1.0)
    b = np.array([1.0, 0.5, -0.3, 0.1, 0.0, 0.02, 2.0, -1.0, 0.2, 0.0, 0.1, 0.0])
    x = np.array([0.1, 0.27, 0.5, 0.8, 0.94, 1.0, 1.27, -0.5])
    force = force_left_of(punches.centre, punches.half_width, punches.first_node, b, x, 1.0)
    whole = np.pi * (0.1 * 1.0 + 0.15 * 2.0)
    # Gauss's quadrature on the part of each contact that lies on the left, in the angle, where nothing is singular.
    angle, weight = np.polynomial.legendre.leggauss(40)
    expected = []
    for position in x:
        turns = np.floor(position - 0.1)
        total = turns * whole
        for j in range(2):
            t = np.clip((position - turns - punches.centre[j]) / punches.half_width[j], -1, 1)
            until = np.arccos(-t)
            theta = np.pi - 0.5 * until * (angle + 1)
            psi = np.polynomial.chebyshev.chebval(np.cos(theta), b[6 * j : 6 * j + 6])
            total += punches.half_width[j] * 0.5 * until * (weight @ psi)
        expected.append(total)
    np.testing.assert_allclose(force, expected, rtol=1e-12, atol=1e-14)
    assert forces_of_expansion(b[:6][None], np.array([0.1]), 6).sum() == pytest.approx(np.pi * 0.1, rel=1e-14)
