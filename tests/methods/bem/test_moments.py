"""Moments of narrow contacts, and the next order of edges that stand alone."""

import numpy as np
import pytest

from weier import Profile, random_phases, solve
from weier.methods.bem import curve, fft
from weier.methods.bem.edge_error import find_steps
from weier.methods.bem.edges import find_edges
from weier.methods.bem.grid_contacts import NARROW, make_contacts
from weier.methods.bem.grid_solution import GridSolution
from weier.methods.bem.grids import full_contact, nested_grids
from weier.methods.bem.moments import add_grid_moments, cotangents, effects_of_moments, yielding
from weier.methods.bem.polynomials import TERMS
from weier.methods.bem.rate import solve_rate

PERIOD = 1.5
TURNS = (np.arange(40) + 0.5) / 40 * np.pi


def parabolic_contacts(places, centres, half_widths, curvatures):
    """Contacts on parabolas whose crests stand `centres` beside the middle of the nodes; rates of others are flat."""
    contacts = make_contacts(len(places), TERMS)
    for at, (place, c, a, k) in enumerate(zip(places, centres, half_widths, curvatures, strict=True)):
        contacts.kind[at], contacts.position[at], contacts.scale[at] = NARROW, place, 1.0
        contacts.centre[at], contacts.half_width[at] = c, a
        contacts.height[at, :3] = -k / 2 * np.array([c * c, -2 * c, 1])
        contacts.force[at], contacts.share[at] = k * a * a / 4, 0.3 + at
    return contacts


def points(contacts, at):
    """Places, forces and shares of quadrature points: Hertz's pressure and that of a flat punch."""
    x = contacts.position[at] + contacts.centre[at] + contacts.half_width[at] * np.cos(TURNS)
    force, share = np.sin(TURNS) ** 2, np.ones(TURNS.size)
    return x, contacts.force[at] * force / force.sum(), contacts.share[at] * share / share.sum()


def effects_of_two(contacts):
    none, cotangent = np.zeros(2), cotangents(contacts, 0, 2, PERIOD)
    return effects_of_moments(contacts, 0, np.ones(2, bool), none, none, cotangent, PERIOD)


def influence(x):
    return -2 * np.log(np.abs(2 * np.sin(np.pi * x / PERIOD)))


def images(x):
    return influence(x) + 2 * np.log(2 * np.pi * np.abs(x) / PERIOD)


def displacement(contacts, at, x, which):
    """At x, by force (1) or share (2) of all contacts, but for what they would do at the middles of their nodes."""
    total = np.zeros(np.shape(x))
    for other in range(contacts.kind.size):
        place = contacts.position[other]
        for y, size in zip(points(contacts, other)[0], points(contacts, other)[which], strict=True):
            if other == at:
                total += size * (images(x - y) - images(x - place + 1e-9))
            else:
                total += size * (influence(x - y) - influence(x - place))
    return total


def test_moments_displace_contacts_and_tilt_and_bend_the_surface():
    contacts = parabolic_contacts((0.2, 0.5), (0.004, -0.006), (0.02, 0.015), (30.0, 50.0))
    effects = effects_of_two(contacts)
    for at in range(2):
        x, step = contacts.position[at], 1e-3
        below, here, above = displacement(contacts, at, x + step * np.array([-1.0, 0.0, 1.0]), 1)
        # The fourth moment is left out: (half width/distance)^2 of the second, and less where signs alternate.
        assert effects.lift[at] == pytest.approx(here, rel=5e-3)
        assert effects.lift_rate[at] == pytest.approx(displacement(contacts, at, x, 2), rel=5e-3)
        assert effects.tilt[at] == pytest.approx((above - below) / (2 * step), rel=2e-2)
        assert effects.bend[at] == pytest.approx((above + below - 2 * here) / step**2, rel=5e-2)


def test_energies_of_moments_are_those_of_the_pressures():
    contacts = parabolic_contacts((0.2, 0.5), (0.004, -0.006), (0.02, 0.015), (30.0, 50.0))
    effects = effects_of_two(contacts)
    mixed = energy = 0.0
    for at in range(2):
        for other in range(2):
            kernel = images if at == other else influence
            x, force, share = points(contacts, at)
            y, _, there = points(contacts, other)
            x_mid, y_mid = contacts.position[at] + 1e-9, contacts.position[other]
            lost = kernel(x_mid - y_mid) - kernel(x - y_mid)[:, None] - kernel(x_mid - y)[None, :]
            both = kernel(x[:, None] - y[None, :] + 1e-12) + lost
            mixed += force @ both @ there
            energy += share @ both @ there
    # The fourth moments are left out: (half width/distance)^2 of the second.
    assert effects.mixed == pytest.approx(mixed, rel=5e-3)
    assert effects.energy == pytest.approx(energy, rel=5e-3)


def test_the_grid_has_moments_of_triangles():
    """Of a triangle from -1 to 1, moved by 2: its mean is 2, and its variance 1/6."""
    x = np.linspace(1, 3, 200_001)
    weight = (1 - np.abs(x - 2)) * (x[1] - x[0])
    moments = np.zeros(3)
    add_grid_moments(3.0, 2.0, 1.0, moments)
    assert moments == pytest.approx([3 * weight @ x**k for k in (1, 2, 3)], rel=1e-6)


def test_a_contact_yields_as_a_parabola_that_is_bent():
    """The half width is 2 sqrt(F/k), so that R changes by u''/k times share^2/L."""
    contacts = parabolic_contacts((0.2, 0.5), (0.0, 0.0), (0.02, 0.015), (30.0, 50.0))
    effects = effects_of_two(contacts)
    found = yielding(contacts, 0, effects, 0, 0.3, PERIOD)
    narrower = np.sqrt(30 / (30 + effects.bend[0]))
    assert found == pytest.approx([-2 * np.log(narrower) * 0.3**2 / PERIOD, 0, 0], rel=1e-3)


def grid_solution(profile, load, nodes):
    """A converged solution on the grid, with its rate."""
    hierarchy = nested_grids(profile, nodes, 1e-12)
    state = fft.make_grid_state(nodes)
    plane, _, _ = fft.cascade(load, hierarchy, full_contact(hierarchy, load), state)
    pressure, deformed = state.pressure.copy(), state.deformed.copy()
    rate, _ = solve_rate(hierarchy, state)
    return GridSolution(plane, rate, pressure, deformed, state.pressure, -state.deformed, state.contact)


def test_the_next_node_closes_as_fast_as_far_from_other_edges():
    """With half a wave in contact q is as large at the next step, and the constant is right to a node of many."""
    profile = Profile(D=1.5, gamma=2, m=1, phases=0.7)
    ratio = []
    for nodes in (1024, 4096):
        solution = grid_solution(profile, 0.5, nodes)
        edge = find_edges(solution.contact, np.zeros(nodes + 2, int))
        ratio.append(find_steps(solution, edge, 0.5, 1.0).stiffer.mean())
    assert np.abs(ratio) == pytest.approx([0, 0], abs=2e-3)
    assert abs(ratio[1]) < abs(ratio[0]) / 3


def test_several_contacts_state_errors_within_one_order():
    """The median over loads where contacts bear on each other: 13 and 19 on random series."""
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
