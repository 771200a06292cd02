"""Edges of contact between the nodes: the constants, the accuracy, its orders, and the errors that are told."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import zeta

from tests.reference import REFERENCES
from weier import Profile, patches, random_phases, westergaard
from weier.bem import curve, polynomials, subgrid
from weier.bem.interaction import solve_positive
from weier.bem.narrow import contact_edges, flat_height, gap_edges
from weier.halfplane import eigenvalues

PER_WAVE = (16, 64, 256)
KNOWN = 1e-3  # two rows below this load are wrong where crests coincide (docs/numerics.md)


def relative(found, resistance):
    """Errors of a resistance, relative from 1e-3 on, absolute below."""
    return np.abs(found - resistance) / np.where(resistance > 1e-3, resistance, 1)


def measured(per_wave):
    """Errors of compliance and resistance over all reference rows, and how much of the expected ones they are."""
    h, R, share = [], [], []
    for reference in REFERENCES:
        rows = reference if reference.mean_pressure[0] < 1e-8 else reference.above(KNOWN)
        points = per_wave * rows.profile.wavenumber[-1]
        found = curve(rows.profile, rows.mean_pressure, points=points)
        h += list(np.abs(found.compliance - rows.compliance))
        R += list(relative(found.resistance, rows.resistance))
        # The reference holds ten digits.
        share += list(np.abs(found.compliance - rows.compliance) / (found.compliance_error + 2e-10))
        share += list(np.abs(found.resistance - rows.resistance) / (found.resistance_error + 1e-8))
    return np.array(h), np.array(R), max(share)


@pytest.fixture(scope="module")
def accuracy():
    return {per_wave: measured(per_wave) for per_wave in PER_WAVE}


@pytest.mark.parametrize(
    ("per_wave", "h", "R"),
    [(16, (1e-5, 5e-4), (3e-4, 2e-2)), (64, (3e-7, 1e-5), (3e-5, 2e-3)), (256, (5e-9, 3e-7), (3e-6, 2e-4))],
)
def test_the_accuracy_is_what_the_docs_say(accuracy, per_wave, h, R):
    compliance, resistance, share = accuracy[per_wave]
    print(f"{per_wave}: h {np.median(compliance):.1e} {compliance.max():.1e}", end=" ")
    print(f"R {np.median(resistance):.1e} {resistance.max():.1e}, {share:.2f} of the expected errors")
    assert np.median(compliance) < h[0]
    assert compliance.max() < h[1]
    assert np.median(resistance) < R[0]
    assert resistance.max() < R[1]
    assert share < 1


def test_the_orders_are_three_and_two():
    """Of the median errors where there is more than one small contact, with a rate that is solved closely.

    The largest errors fall more unevenly: single loads stand near births, or on contacts that bear on each other.
    """
    grids, medians, largest = (16, 32, 64, 128, 256), [], []
    for per_wave in grids:
        h, R = [], []
        for reference in REFERENCES:
            rows = reference.above(KNOWN)
            points = per_wave * rows.profile.wavenumber[-1]
            found = curve(rows.profile, rows.mean_pressure, points=points, tolerance=1e-12)
            h += list(np.abs(found.compliance - rows.compliance))
            R += list(relative(found.resistance, rows.resistance))
        medians.append((np.median(h), np.median(R)))
        largest.append((np.max(h), np.max(R)))
    orders, worst = (-np.polyfit(np.log(grids), np.log(errors), 1)[0] for errors in (medians, largest))
    print(f"orders {orders[0]:.2f} and {orders[1]:.2f}; of the largest errors {worst[0]:.2f} and {worst[1]:.2f}")
    assert orders[0] >= 2.7
    assert orders[1] >= 1.8
    assert worst[0] >= 2.3
    assert worst[1] >= 1.7


def test_the_edge_of_a_punch_is_that_of_wiener_and_hopf():
    """The factor of 2 sin(theta/2) times the symbol: 1/4 - 1/2 of an integral."""

    def symbol(kappa):
        return np.sin(np.pi * kappa) ** 2 / np.pi**2 * (zeta(3, kappa) + zeta(3, 1 - kappa))

    def integrand(kappa):
        return np.log(symbol(kappa) * np.sin(np.pi * kappa) / np.pi) / np.sin(np.pi * kappa) ** 2

    assert pytest.approx(0.25 - quad(integrand, 1e-6, 0.5)[0] / 2, abs=1e-6) == subgrid.EDGE


def test_the_constant_of_the_compliance_follows_from_the_symbol():
    """It is 1/12 + eta/2, where long waves have the eigenvalue (1 + eta theta^2)/|k|."""
    theta = 2 * np.pi * 20 / 4096
    eta = (eigenvalues(4096)[20] * 20 - 1) / theta**2
    assert pytest.approx(1 / 12 + eta / 2, rel=1e-2) == subgrid.CURVATURE


def test_one_wave_is_westergaards():
    loads = np.geomspace(1e-9, 0.999, 200)
    for per_wave, h, R in ((16, 2e-4, 2e-2), (64, 2e-6, 1e-3), (255, 3e-7, 1e-4)):
        found = curve(Profile(1.25, 5, 1, 0.3), loads, points=per_wave)
        assert np.abs(found.compliance - westergaard.compliance(loads)).max() < h
        exact = westergaard.resistance(loads)
        assert relative(found.resistance, exact).max() < R
        fraction = 2 / np.pi * np.arcsin(np.sqrt(loads))
        assert np.abs(found.contact_fraction - fraction).max() < 0.3 / per_wave**2


PROFILES = [
    Profile(1.3, 2, 3, (0.0, np.pi, 0.0)),  # crests that coincide
    Profile(1.6, "5/3", 3, random_phases(3)),
    Profile(1.1, 4, 2, (0.0, np.pi)),
    Profile(1.9, 3, 2, random_phases(4)),
    Profile(1.25, 5, 2, (-2 * np.pi * 0.5 / 80, -2 * np.pi * 2.5 / 80)),  # crests half a node off
]


@pytest.mark.parametrize("profile", PROFILES, ids=str)
@pytest.mark.parametrize("odd", [0, 1])
def test_numbers_lie_within_their_errors(profile, odd):
    loads = np.geomspace(1e-9, 4, 30)
    exact = patches.curve(profile, loads)
    found = curve(profile, loads, points=16 * profile.wavenumber[-1] + odd)
    assert np.all(np.abs(found.compliance - exact.compliance) <= found.compliance_error + 1e-12)
    assert np.all(np.abs(found.resistance - exact.resistance) <= found.resistance_error + 1e-9)
    assert np.mean(found.patch_count == exact.patch_count) >= 0.95
    assert np.abs(found.contact_fraction - exact.contact_fraction).max() < 5e-3


def test_loads_before_full_contact_are_between_the_nodes():
    """The last gap closes between two nodes: the grid is in full contact before."""
    profile = Profile(1.25, 5, 1, np.pi / 16)
    found = curve(profile, [0.995], points=16)
    assert 0 < found.resistance[0] < 0.01
    assert found.contact_fraction[0] < 1
    assert found.patch_count[0] == 1


def test_without_resistance_the_compliance_is_the_same():
    profile, loads = Profile(1.25, 5, 2, 1.0), np.array([0.01, 0.3])
    one, other = (curve(profile, loads, resistance=wanted) for wanted in (True, False))
    assert other.compliance.tolist() == one.compliance.tolist()
    assert np.all(np.isnan(other.resistance))


def test_both_numbers_cost_28_pairs():
    """Pairs of FFTs a load on 32768 nodes, to a residual of 1e-8."""
    profile = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
    found = curve(profile, np.geomspace(1e-3, 2, 40), points=32768, tolerance=1e-8)
    assert found.work.mean() <= 28


def test_a_parabola_is_hertz_and_a_quartic_gap_closes_at_both_ends():
    height = np.zeros(polynomials.TERMS)
    height[[0, 1, 2]] = 0.3, 0.2, -1.0
    assert contact_edges(height, 0.02, 0.0, 0.3) == pytest.approx((0.1, 0.2, True))
    flat = flat_height(height, 0.02, 0.0, 0.3, 1.0, 10.0)[0]
    # Above the crest by U = 2F(1/2 - ln(pi a/L)).
    assert flat == pytest.approx(0.31 - 2 * 0.02 * (0.5 - np.log(np.pi * 0.2 / 10)))
    pressure = np.zeros(polynomials.TERMS)
    pressure[[0, 2]] = -0.02, 1.0
    assert gap_edges(pressure, 0.05, 0.1) == pytest.approx((0.0, 0.2, True))


def test_polynomials_are_fitted_exactly_where_they_can_be():
    s = np.linspace(-1, 1, 12)
    wanted = np.arange(1.0, polynomials.TERMS + 1)
    values = sum(c * s**k for k, c in enumerate(wanted))
    fitted = polynomials.fit_polynomials(s, values[None], polynomials.DEGREE)
    assert fitted[0] == pytest.approx(wanted, rel=1e-9)
    chebyshev = polynomials.expansion(wanted, 0.2, 0.5)
    assert chebyshev == pytest.approx(
        np.polynomial.chebyshev.Chebyshev.interpolate(
            lambda t: sum(c * (0.2 + 0.5 * t) ** k for k, c in enumerate(wanted)), polynomials.DEGREE
        ).coef
    )


def test_a_matrix_that_is_not_positive_is_refused():
    assert not solve_positive(np.array([[1.0, 2.0], [2.0, 1.0]]), np.ones((2, 1)))
    right = np.ones((2, 1))
    assert solve_positive(np.array([[2.0, 1.0], [1.0, 2.0]]), right)
    assert right[:, 0] == pytest.approx([1 / 3, 1 / 3])
