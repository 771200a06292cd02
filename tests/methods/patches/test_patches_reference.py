"""Contact patches against the reference values, Westergaard, higher precision and boundary elements."""

import mpmath as mp
import numpy as np
import pytest

from tests.profiles import THREE_WAVES, TWIN_CRESTS
from tests.reference import REFERENCES
from weier import Profile
from weier.methods import bem, patches, westergaard


@pytest.mark.parametrize("reference", REFERENCES, ids=str)
def test_reference_values(reference):
    curve = patches.curve(reference.profile, reference.mean_pressure)
    h = np.abs(curve.compliance - reference.compliance).max()
    area = np.abs(curve.contact_fraction - reference.contact_fraction).max()
    pressed = reference.resistance > 0
    ratio = curve.resistance[pressed] / reference.resistance[pressed]
    print(f"{reference}: h {h:.0e}, R {np.abs(ratio - 1).max():.0e}, contact {area:.0e}")
    assert h < 1e-10  # the digits of the reference values
    assert area < 1e-10
    assert np.abs(ratio - 1).max() < 1e-9
    np.testing.assert_array_equal(curve.resistance[~pressed], 0)
    np.testing.assert_array_equal(curve.patch_count, reference.patches)


def test_twin_crests_are_touched_together():
    loads = np.array([1e-6, 7.8e-6, 1e-3])
    curve = patches.curve(TWIN_CRESTS, loads)
    np.testing.assert_array_equal(curve.patch_count, 2)
    elements = bem.curve(TWIN_CRESTS, loads, points=2**15, tolerance=1e-9)
    # Nodes beside the crests, z'' h^2/8 = 1e-8 below them, and a contact of few nodes at the lightest load.
    np.testing.assert_allclose(curve.compliance, elements.compliance, atol=1e-7)


def test_one_wave_is_westergaard():
    xi = np.array([1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.3, 0.6, 0.9, 0.999, 1 - 1e-6, 1.0, 2.0])
    curve = patches.curve(Profile(1.5, 3, 1, 0.7), xi)
    np.testing.assert_allclose(curve.indentation, westergaard.compliance(xi), rtol=1e-12)
    np.testing.assert_allclose(curve.resistance, westergaard.resistance(xi), rtol=1e-9)
    width = 2 / np.pi * np.arcsin(np.sqrt(np.minimum(xi, 1)))
    np.testing.assert_allclose(curve.contact_fraction, width, rtol=1e-12)
    np.testing.assert_array_equal(curve.patch_count, xi < 1)


@pytest.mark.parametrize("xi", [1e-6, 0.3, 0.9])
def test_one_wave_has_westergaards_pressure(xi):
    sine = np.sqrt(xi)
    x = np.arcsin(sine) / np.pi * np.linspace(-0.999, 0.999, 41)
    expected = 2 * xi * np.cos(np.pi * x) / sine**2 * np.sqrt(sine**2 - np.sin(np.pi * x) ** 2)
    solution = patches.solve_load(Profile(1.5, 3, 1), xi)
    np.testing.assert_allclose(solution.pressure(x), expected, rtol=1e-9)
    edge = 2 * xi * np.sqrt(np.pi * np.sin(2 * np.pi * solution.half_width[0])) * np.sqrt(1 - xi) / xi
    np.testing.assert_allclose(solution.edge_strength, edge, rtol=1e-8)


@pytest.mark.parametrize("load", [1e-12, 1e-7])
def test_light_loads_keep_ten_digits(load):
    profile = Profile(1.25, 5, 3, (0.3, 1.0, 2.0))
    curve = patches.curve(profile, load)
    approach, half_width = lone_contact(profile, load)
    assert curve.indentation[0] == pytest.approx(approach, rel=1e-11)
    assert curve.contact_fraction[0] == pytest.approx(2 * half_width, rel=1e-11)


def lone_contact(profile: Profile, load: float, count: int = 6) -> tuple[float, float]:
    """Indentation and half-width of the contact at the crest, collocated with 40 digits."""
    with mp.workdps(40):
        terms = zip(profile.amplitude, profile.waves_per_period, profile.phase, strict=True)
        waves = [(mp.mpf(float(g)), 2 * mp.pi * k, mp.mpf(float(phi))) for g, k, phi in terms]

        def height(x, order):
            return mp.fsum(g * mp.mpf(k) ** order * mp.cos(k * x + phi + order * mp.pi / 2) for g, k, phi in waves)

        crest = mp.findroot(lambda x: height(x, 1), mp.mpf(profile.crest[0]))
        nodes = [mp.cos(q * mp.pi / (count + 1)) for q in range(1, count + 1)]
        points = [mp.cos((a + mp.mpf(1) / 2) * mp.pi / (count + 1)) for a in range(count + 1)]
        weights = [mp.pi / (count + 1) * (1 - s * s) for s in nodes]
        scale = mp.sqrt(4 * load / -height(crest, 2))
        steepness = -height(crest, 2) * scale / (2 * mp.pi)

        def equations(*unknowns):
            *phi, c, r, approach = unknowns
            phi, r, x = [steepness * value for value in phi], scale * r, crest + scale * c
            share = [r * w * value for w, value in zip(weights, phi, strict=True)]
            pushes = [mp.fdot(share, [mp.cot(mp.pi * r * (t - s)) for s in nodes]) for t in points]
            slopes = [height(x + r * t, 1) / (2 * mp.pi) for t in points]
            residuals = [(push + slope) / steepness for push, slope in zip(pushes, slopes, strict=True)]
            # ln|2 sin(pi d)| = ln(2 pi d) - (pi d)^2/6 - ..., d below 1e-4
            smooth = [mp.log(2 * mp.pi * r) - (mp.pi * r * s) ** 2 / 6 for s in nodes]
            potential = mp.fdot(share, smooth) + r * logarithmic_moment(phi, count)
            residuals.append((2 * potential + approach * load + height(x, 0) - height(crest, 0)) / load)
            residuals.append(mp.fsum(share) / load - 1)
            return residuals

        start = [mp.mpf(1)] * count + [mp.mpf(0), mp.mpf(1), 1 - 2 * mp.log(mp.pi * scale)]
        found = mp.findroot(equations, start, tol=mp.mpf(10) ** -50)
        return float(found[count + 2] * load), float(found[count + 1] * scale)


def logarithmic_moment(phi, count):
    """int sqrt(1-s^2) phi(s) ln|s| ds by the closed form for each U_k."""
    total = mp.mpf(0)
    for k in range(count):
        angles = [(q + 1) * mp.pi / (count + 1) for q in range(count)]
        basis = [mp.sin(angle) * mp.sin((k + 1) * angle) for angle in angles]
        a = 2 * mp.fdot(basis, phi) / (count + 1)
        low = -mp.pi * mp.log(2) if k == 0 else -mp.pi / k * mp.cos(k * mp.pi / 2)
        total += a * (low + mp.pi / (k + 2) * mp.cos((k + 2) * mp.pi / 2)) / 2
    return total


@pytest.mark.parametrize("profile", [THREE_WAVES, Profile(1.6, "5/2", 3, (0.0, 2.0, 4.0))])
def test_boundary_elements_agree_within_their_error(profile):
    loads = np.geomspace(1e-2, 4.0, 60)
    exact = patches.curve(profile, loads)
    most = []
    for per_wave in (32, 64, 128):
        elements = bem.curve(profile, loads, points=per_wave * profile.waves_per_period[-1])
        error = np.abs(elements.compliance - exact.compliance)
        assert np.all(error <= elements.compliance_error)
        most.append(np.quantile(error, 0.9))
    print(f"gamma {profile.gamma}: {most}")
    assert most[0] < 2e-6  # 7e-7 and 1.5e-6
    assert most[2] < most[0] / 16  # an order of 2 at least: single loads vary with where their edges stand
