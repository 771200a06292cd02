"""How contacts displace each other, and what errors they state where they do."""

import numpy as np
import pytest

from weier import Profile, random_phases, solve
from weier.methods.bem import curve
from weier.methods.bem.contacts import CONTACT, displacement_by_edges
from weier.methods.bem.grid_solution import make_continuum
from weier.methods.bem.grids import grid_of, nested_grids
from weier.methods.bem.interaction import displace, make_interaction, press
from weier.methods.bem.redistribution import solve_bordered
from weier.methods.punches import invert_punches

PERIOD, POINTS = 1.0, 2048
PLACES = np.array([0.2, 0.3512, 0.7])


def kernel(x):
    """Displacement at x by a unit force."""
    return -2 * np.log(np.abs(2 * np.sin(np.pi * x / PERIOD)))


def images(x):
    """Displacement at x by the images of a unit force at 0, without the force itself."""
    return kernel(x) + 2 * np.log(2 * np.pi * np.abs(x) / PERIOD)


@pytest.fixture
def three_contacts():
    """Contacts in line, on a grid much finer than their distances."""
    profile = Profile(1.25, 5, 1)
    grid = grid_of(nested_grids(profile, POINTS, 1e-10), 4)
    assert grid.height.size == POINTS
    return make_interaction(PLACES, make_continuum(profile, grid))


def by_punch(x, left, right):
    """Displacement at x by a flat punch of unit force: on it, and beside it."""
    sine = np.sin(np.pi * (right - left) / (2 * PERIOD))
    beside = np.abs(np.sin(np.pi * (x - (left + right) / 2) / PERIOD)) / sine
    return -2 * np.log(sine), -2 * (np.arccosh(beside) + np.log(sine))


@pytest.mark.parametrize("x", [0.31, 0.4, 0.5, 0.62, 0.69, 0.8, 0.89])
@pytest.mark.parametrize("which", ["left", "right"])
def test_an_edge_that_moves_displaces_what_is_beside_its_contact(which, x):
    """As the edge of a flat punch does: its change has no force, displaces the contact evenly, and is as singular."""
    middle, half_width, step = 0.1, 0.2, 1e-5
    contact = np.zeros(1, CONTACT)[0]
    contact["position"], contact["share"] = middle, 0.7
    contact["self_compliance"] = -2 * np.log(np.sin(np.pi * half_width / PERIOD))
    contact[f"{which}_compliance"] = -contact["share"] / PERIOD  # which raises the plane by 1
    edges = {"left": middle - half_width, "right": middle + half_width}
    (on, beside), (on_after, beside_after) = (by_punch(x, **edges | {which: edges[which] + s}) for s in (-step, step))
    expected = -(beside_after - beside) / (on_after - on)  # the higher the plane, the less the contact is displaced
    assert displacement_by_edges(contact, x, PERIOD)[0] == pytest.approx(expected, rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("compliance", [1e-6, -1.0])
def test_a_step_that_is_not_known_is_no_small_one(compliance, three_contacts):
    """Else the search for forces would end there: narrow punches so near to each other have more compliance."""
    slope, right = np.full(3, compliance), np.array([1.0, -1.0, 0.0])
    inverse = invert_punches(np.arange(3), PLACES, slope, PERIOD)
    step, found = solve_bordered(slope, right, 0.0, 1e-14, three_contacts, inverse)
    assert not found
    assert np.all(np.isinf(step))


def test_moments_displace_and_tilt_and_bend_the_surface(three_contacts):
    """As two forces at a distance of each other do that have these moments."""
    apart, force = 0.004, np.array([0.3, 0.5, 1.0])
    offset = np.array([0.002, -0.001, 0.0])
    moments = np.stack([force * (offset - apart) ** k + force * (offset + apart) ** k for k in range(4)], axis=1) / 2
    effects = displace(moments, three_contacts)
    for i, x in enumerate(PLACES):
        u = np.zeros(4)
        step = 2e-3 * np.array([-1.0, -1 / 3, 1 / 3, 1.0])
        for j, y in enumerate(PLACES):
            of = images if i == j else kernel
            for side in (-apart, apart):
                u += force[j] / 2 * of(x + step - y - offset[j] - side)
        expected = np.polynomial.polynomial.polyfit(step, u, 3)
        # Fourth moments are left out: (0.004/0.15)^4, the half distance over that of contacts, in the displacement.
        assert effects[i, 0] == pytest.approx(expected[0], rel=2e-6)
        assert effects[i] == pytest.approx(expected, rel=1e-2, abs=1e-2)


def test_few_contacts_and_many_displace_each_other_alike(three_contacts):
    """By a matrix, and by a product on the grid."""
    force = np.array([1.0, -0.3, 0.5])
    expected = [sum(kernel(x - y) * f for y, f in zip(PLACES, force, strict=True) if y != x) for x in PLACES]
    none = np.zeros((0, 0))
    assert press(force, three_contacts) == pytest.approx(expected, rel=1e-12)
    assert press(force, three_contacts._replace(mutual=none)) == pytest.approx(expected, abs=1e-4)  # triangles


def test_several_contacts_state_errors_that_are_neither_too_small_nor_too_wide():
    """Stated over true errors where contacts bear on each other: from 10 and 3.7 on, with medians of 28 and 27.

    Without the moments of contacts the least would be 0.02, and with twice the factor of what second moments change
    the medians would be 47 and 37.
    """
    wider = []
    for seed, D in ((1, 1.25), (2, 1.6), (3, 1.4)):
        profile = Profile(D, 4, 3, random_phases(seed))
        loads = profile.full_contact_load * np.geomspace(1e-3, 0.5, 25)
        exact, found = solve(profile, loads, "patches"), curve(profile, loads, points=16 * 16)
        several = exact.patch_count.values > 1
        h, R = (np.abs(getattr(found, name) - exact[name].values) for name in ("compliance", "resistance"))
        wider.append(np.array([found.compliance_error / h, found.resistance_error / R])[:, several])
    wider = np.concatenate(wider, axis=1)
    assert wider.min() > 1
    assert np.all(np.median(wider, axis=1) < 30)
