"""Edges of contact between the nodes: the constant, the accuracy, and the errors that are told."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import zeta

from tests.reference import REFERENCES
from weier import ConvergenceError, Profile, random_phases, solve
from weier.methods import patches, westergaard
from weier.methods.bem import curve, local_fit
from weier.methods.bem.solver import full_contact_load
from weier.methods.bem.subgrid_solver import GridSolver

SEVERAL = 1e-3  # p_0*, from which on more than one small contact carries the load


def relative(found, resistance):
    """Errors of a resistance, relative from 1e-3 on, absolute below."""
    return np.abs(found - resistance) / np.where(resistance > 1e-3, resistance, 1)


def measured(per_wave, **settings):
    """Errors of h and R over all reference rows, which have several contacts, the largest share of the stated."""
    h, R, several, share = [], [], [], []
    for reference in REFERENCES:
        found = curve(reference.profile, reference.mean_pressure, points_per_wave=per_wave, **settings)
        h += list(np.abs(found.compliance - reference.compliance))
        R += list(relative(found.resistance, reference.resistance))
        several += list(reference.mean_pressure >= SEVERAL)
        # The reference holds ten digits.
        share += list(np.abs(found.compliance - reference.compliance) / (found.compliance_error + 2e-10))
        share += list(np.abs(found.resistance - reference.resistance) / (found.resistance_error + 1e-8))
    return np.array(h), np.array(R), np.array(several), max(share)


@pytest.mark.parametrize(
    ("per_wave", "h", "R"),
    [
        (16, (5e-8, 9e-5), (5e-6, 6e-3)),
        (32, (3e-9, 5e-6), (3e-7, 1e-3)),
        (64, (6e-10, 7e-6), (1.3e-7, 1.3e-3)),
        (256, (1e-11, 1.5e-8), (8e-9, 4e-5)),
    ],
)
def test_the_accuracy_is_what_was_measured(per_wave, h, R):
    """Medians where there are several contacts, and the largest errors: twice what they were, for other machines."""
    compliance, resistance, several, share = measured(per_wave)
    assert np.median(compliance[several]) < h[0]
    assert compliance.max() < h[1]
    assert np.median(resistance[several]) < R[0]
    assert resistance.max() < R[1]
    assert share < 1


def test_the_edge_of_a_punch_is_that_of_wiener_and_hopf():
    """The factor of 2 sin(theta/2) times the symbol: 1/4 - 1/2 of an integral."""

    def symbol(kappa):
        return np.sin(np.pi * kappa) ** 2 / np.pi**2 * (zeta(3, kappa) + zeta(3, 1 - kappa))

    def integrand(kappa):
        return np.log(symbol(kappa) * np.sin(np.pi * kappa) / np.pi) / np.sin(np.pi * kappa) ** 2

    assert pytest.approx(0.25 - quad(integrand, 1e-6, 0.5)[0] / 2, abs=1e-6) == local_fit.EDGE


def test_one_wave_is_westergaards():
    loads = np.geomspace(1e-9, 0.999, 200)
    light = loads < 1e-3  # R is right to more digits, if the contact is as wide as the curvature by its images has it
    for per_wave, h, R, R_of_light in ((32, 1e-5, 3e-3, 4e-9), (64, 2e-6, 1e-3, 4e-11), (255, 3e-7, 1e-4, 5e-12)):
        found = curve(Profile(1.25, 5, 1, (0.3,)), loads, points=per_wave)
        assert np.abs(found.compliance - westergaard.compliance(loads)).max() < h
        exact = westergaard.resistance(loads)
        assert relative(found.resistance, exact).max() < R
        assert np.median(np.abs(found.resistance - exact)[light]) < R_of_light
        fraction = 2 / np.pi * np.arcsin(np.sqrt(loads))
        assert np.abs(found.contact_fraction - fraction).max() < 0.3 / per_wave**2


PROFILES = [
    Profile(1.3, 2, 3, (0.0, np.pi, 0.0)),  # crests that coincide
    Profile(1.6, "5/3", 3, random_phases(3)),
    Profile(1.1, 4, 2, (0.0, np.pi)),
    Profile(1.9, 3, 2, random_phases(4)),
    Profile(1.25, 5, 2, (-2 * np.pi * 0.5 / 160, -2 * np.pi * 2.5 / 160)),  # crests half a node off
]


def edge_deviation(profile, found, exact):
    """Largest distance between edges of the same load, in the finest waves."""
    period = float(profile.period)
    apart = (found[~np.isnan(found)] - exact[~np.isnan(exact)] + period / 2) % period - period / 2
    return np.abs(apart).max(initial=0.0) * profile.waves_per_period[-1] / period


@pytest.mark.parametrize("profile", PROFILES, ids=str)
@pytest.mark.parametrize(("per_wave", "odd", "deviation"), [(32, 0, 1e-3), (32, 1, 1e-3), (128, 0, 6e-5)])
def test_numbers_and_edges_lie_within_their_errors(profile, per_wave, odd, deviation):
    """Edges for four of five loads: next to births one moves as the root of the height."""
    loads, points = np.geomspace(1e-9, 4, 30), per_wave * profile.waves_per_period[-1] + odd
    exact, found = patches.curve(profile, loads), curve(profile, loads, points=points)
    assert np.all(np.abs(found.compliance - exact.compliance) <= found.compliance_error + 1e-12)
    assert np.all(np.abs(found.resistance - exact.resistance) <= found.resistance_error + 1e-9)
    assert found.patch_count.tolist() == exact.patch_count.tolist()
    assert np.abs(found.contact_fraction - exact.contact_fraction).max() < 4e-4  # twice the largest measured
    deviations = [edge_deviation(profile, *each) for each in zip(found.contact_edge, exact.contact_edge, strict=True)]
    assert np.quantile(deviations, 0.8) < deviation


@pytest.mark.parametrize("load", [1e-6, 1e-2, 0.5, 2.0])
def test_listed_contacts_carry_the_load_between_their_edges(load):
    profile = PROFILES[1]
    found, listed = curve(profile, [load]), GridSolver(profile, 32 * profile.waves_per_period[-1], 1e-10).solve(load)
    assert (
        found.contact_edge[0].tolist()
        == np.stack([listed.contacts["left"], listed.contacts["right"]], 1).ravel().tolist()
    )
    assert listed.contacts["force"].sum() == pytest.approx(load * profile.period, rel=1e-6)
    assert np.all(np.diff(listed.contacts["left"]) > 0)


def test_a_gap_of_a_node_that_the_continuum_has_not_is_closed():
    """Where two contacts merge, the grid keeps the last node apart for too long."""
    profile = Profile(1.23663, "3/2", 2, (np.pi, np.pi))
    load = np.array([0.82839])
    exact, found = patches.curve(profile, load), curve(profile, load, points=96)
    assert curve(profile, load, points=96, edges="nodes").patch_count.tolist() == [3]
    assert found.patch_count.tolist() == exact.patch_count.tolist() == [1]
    assert edge_deviation(profile, found.contact_edge[0], exact.contact_edge[0]) < 2e-4
    assert np.abs(found.compliance - exact.compliance) <= found.compliance_error
    assert np.abs(found.resistance - exact.resistance) <= found.resistance_error


def test_the_right_one_of_two_crests_carries_light_loads():
    """On this grid the lower crest has the higher node: its contact lets go, and the other is born between nodes."""
    profile, loads = Profile(1.56748, 10, 2, (2.90991, 0.885789)), np.geomspace(2e-9, 1e-4, 25)
    exact, found = patches.curve(profile, loads), curve(profile, loads, points=160)
    # The exact curve holds ten digits.
    assert np.all(np.abs(found.compliance - exact.compliance) <= found.compliance_error + 1e-12)
    assert np.abs(found.compliance - exact.compliance).max() < 1e-6
    assert np.abs(found.resistance / exact.resistance - 1).max() < 1e-4
    edges = zip(found.contact_edge, exact.contact_edge, strict=True)
    assert max(edge_deviation(profile, *row) for row in edges) < 1e-4


def test_the_lightest_loads_and_the_verge_of_full_contact_are_right():
    """From Hertz's contact of 1e-140 to a gap that no digit shows."""
    profile, loads = Profile(1.25, 5, 1, (0.3,)), np.array([1e-280, 1e-100, 1e-30, 1 - 1e-9, 1 - 1e-15])
    found = curve(profile, loads, points=32)
    assert np.all(np.abs(found.resistance - westergaard.resistance(loads)) <= found.resistance_error)
    assert np.all(np.abs(found.compliance - westergaard.compliance(loads)) <= found.compliance_error)
    assert np.all(found.compliance <= 1)
    assert np.all(found.resistance >= 0)


def test_load_off_the_nodes_is_seen_by_the_images():
    """One contact, a third of a node off its node: without its first moment the resistance is off by 7e-4."""
    loads = np.geomspace(1e-6, 1e-3, 10)
    found = curve(Profile(1.25, 5, 1, (2 * np.pi / 3 / 32,)), loads, points=32)
    assert np.abs(found.resistance - westergaard.resistance(loads)).max() < 3e-6


def test_a_gap_between_two_nodes_is_found():
    """The last gap closes half a node off: the grid is in full contact before."""
    profile, loads = Profile(1.25, 5, 1, (np.pi / 32,)), np.array([0.9985, 0.999, 0.9999, 0.99999])
    assert full_contact_load(profile, 32) < loads[0]
    found = curve(profile, loads, points=32)
    compliance, resistance = westergaard.compliance(loads), westergaard.resistance(loads)
    assert np.all(np.abs(found.compliance - compliance) <= found.compliance_error)
    assert np.all(np.abs(found.resistance - resistance) <= found.resistance_error)
    assert np.all(found.contact_fraction < 1)
    assert found.patch_count.tolist() == [1, 1, 1, 1]


@pytest.mark.parametrize("settings", [{"points_per_wave": 16}, {"points_per_wave": 3, "edges": "nodes"}])
def test_points_may_be_given_for_each_of_the_finest_waves(settings):
    """The finest of 5/2 and m = 3 fits 25 times into the period, which is 4."""
    profile, loads = Profile(1.25, "5/2", 3, 1.0), [0.01, 0.3]
    points = 25 * settings["points_per_wave"]
    given = solve(profile, loads, "bem", **settings)
    named = solve(profile, loads, "bem", points=points, **{"edges": "subgrid"} | settings | {"points_per_wave": None})
    assert (given.points, given.points_per_wave) == (points, settings["points_per_wave"])
    np.testing.assert_array_equal(given.compliance, named.compliance)


def test_every_curve_states_the_error_of_its_compliance():
    """With edges on nodes it holds in full contact, too: there the grid is in full contact too early."""
    profile, loads = Profile(1.25, 5, 2, 1.0), [0.01, 0.3, 10.0]
    between, on_nodes = (solve(profile, loads, "bem", edges=edges) for edges in ("subgrid", "nodes"))
    assert np.all(between.compliance_error[:2] > 0)
    assert np.all(between.resistance_error[:2] > 0)
    assert between.compliance_error[2] == between.resistance_error[2] == 0  # in full contact all is known
    deviation = np.abs(on_nodes.compliance - between.compliance)
    assert np.all(deviation <= on_nodes.compliance_error + between.compliance_error)
    assert np.all(on_nodes.compliance_error > 0)
    assert np.all(on_nodes.resistance_error.isnull())


def test_a_thousand_contacts_between_narrow_gaps_stand_on_one_plane():
    """The last step of their forces is all rounding, in which conjugate gradients do not converge."""
    profile, points = Profile(1.25, 5, 6), 16 * 5**5
    found = GridSolver(profile, points, 1e-10).solve(10.0)
    assert found.contacts.size > 900
    assert found.verified


def test_a_load_that_is_not_verified_is_solved_more_finely(monkeypatch):
    """On a finer grid, or by contact patches; it is refused where these fail too."""
    profile, load = Profile(1.25, 5, 2, (0.0, 1.0)), [0.1, 0.3]
    exact, solve_load = patches.curve(profile, load), GridSolver.solve
    refused = [160]

    def unverified(solver, load):
        solved = solve_load(solver, load)
        return solved._replace(verified=solver.nested.grid.height.size not in refused)

    monkeypatch.setattr(GridSolver, "solve", unverified)
    finer = curve(profile, load, points=160)
    by_itself = curve(profile, load, points=320)
    np.testing.assert_allclose(finer.compliance, by_itself.compliance, atol=1e-10)  # the residual
    refused += [320, 640]
    found = curve(profile, load, points=160)
    np.testing.assert_allclose(found.compliance, exact.compliance, rtol=1e-12)
    np.testing.assert_allclose(found.resistance, exact.resistance, rtol=1e-12)
    assert found.patch_count.tolist() == exact.patch_count.tolist()
    assert np.all((exact.compliance_error <= found.compliance_error) & (found.compliance_error <= 1e-11))
    np.testing.assert_allclose(found.contact_edge, exact.contact_edge, rtol=1e-12)

    def failing(*arguments):
        raise ConvergenceError("nothing", 1.0)

    monkeypatch.setattr(patches, "curve", failing)
    with pytest.raises(ConvergenceError, match=r"neither .* nor contact patches .* pressure 0\.3 p_0"):
        curve(profile, load, points=160)


@pytest.mark.parametrize("edges", ["nodes", "subgrid"])
def test_without_resistance_no_work_is_done_for_it(edges):
    """On nodes its rate is not solved for; between them the compliance needs it, too."""
    profile, loads = Profile(1.25, 5, 2, 1.0), np.array([0.01, 0.3])
    one, other = (curve(profile, loads, resistance=wanted, edges=edges) for wanted in (True, False))
    assert other.compliance.tolist() == one.compliance.tolist()
    assert np.all(np.isfinite(one.resistance))
    assert np.all(np.isnan(other.resistance))
    assert np.all(other.work < one.work) if edges == "nodes" else np.all(other.work == one.work)


def test_both_numbers_cost_30_pairs():
    """Pairs of FFTs a load on 800 nodes, to a residual of 1e-8."""
    found = curve(Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), np.geomspace(1e-3, 2, 40), tolerance=1e-8)
    print(f"{found.work.mean():.1f} pairs")
    assert found.work.mean() <= 30
