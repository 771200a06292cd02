"""What any solution must obey: complementarity, energy, symmetry, and the limits of the input."""

import numpy as np
import pytest
import scipy

from tests.profiles import THREE_WAVES
from weier import Profile
from weier.kernels.arrays import Array
from weier.methods import bem, patches
from weier.methods.patches.inequalities import Violations, error_bound
from weier.methods.patches.surface import surface_of

LOADS = np.geomspace(1e-3, 2, 40)


def assert_complementary(profile: Profile, load: float, points: int = 4001) -> patches.Solution:
    """p > 0 and gap 0 on the contacts, gap > 0 between them, and the load, off the solver's nodes."""
    solution = patches.solve_load(profile, load)
    x = (np.arange(points) + 0.5) * (profile.period / points)
    p, gap = solution.pressure(x), solution.gap(x)
    inside = np.zeros(points, bool)
    for left, right in solution.edges:
        inside |= (x - left) % profile.period < right - left
    assert np.all(p[inside] > 0)
    assert np.all(gap[~inside] > 0)
    carried, x, u = from_the_pressure(solution, profile.period)
    assert carried == pytest.approx(load, rel=1e-11)
    np.testing.assert_allclose(solution.mean_gap - profile.height(x) + u, 0, atol=1e-11)  # of 30 contacts and more
    return solution


def from_the_pressure(solution: patches.Solution, period: float, count: int = 512) -> tuple[float, Array, Array]:
    """Mean pressure, places on the contacts and the displacement there, by a quadrature of its own.

    With s = c + r cos(theta), r p(s) sin(theta) is a series in cos(n theta) on each contact, and
    ln|cos(alpha) - cos(theta)| = -ln 2 - sum (2/n) cos(n alpha) cos(n theta) gives its own logarithm in closed form.
    """
    theta, alpha = (np.arange(count) + 0.5) * np.pi / count, np.linspace(0, np.pi, 8)  # no sevenths among the first
    n = np.arange(1, count)
    x = solution.centre[:, None] + solution.half_width[:, None] * np.cos(alpha)
    carried, u = 0.0, np.zeros_like(x)
    for j, (centre, half_width) in enumerate(zip(solution.centre, solution.half_width, strict=True)):
        s = centre + half_width * np.cos(theta)
        density = half_width * solution.pressure(s) * np.sin(theta)
        kernel = np.abs(2 * np.sin(np.pi * (x[..., None] - s) / period))
        kernel[j] /= np.abs(np.cos(alpha)[:, None] - np.cos(theta))
        u -= 2 * np.log(kernel) @ density * np.pi / count
        wave = scipy.fft.dct(density) / count
        u[j] += np.pi * wave[0] * np.log(2) + 2 * np.pi * np.cos(np.outer(alpha, n)) @ (wave[1:] / n)
        carried += np.pi * density.mean()
    return carried / period, x, u


def random_case(seed: int) -> tuple[Profile, float]:
    rng = np.random.default_rng(seed)
    gamma = (2, 3, 4, 5, "5/2", "7/2")[rng.integers(6)]
    m = int(rng.integers(1, 4))
    profile = Profile(rng.uniform(1.05, 1.95), gamma, m, rng.uniform(0, 2 * np.pi, m))
    return profile, float(np.exp(rng.uniform(np.log(1e-8), np.log(surface_of(profile).full_contact_load))))


@pytest.mark.parametrize("seeds", [range(40), pytest.param(range(40, 340), marks=pytest.mark.slow)], ids=len)
def test_random_cases_are_complementary(seeds):
    for seed in seeds:
        profile, load = random_case(seed)
        assert_complementary(profile, load)


@pytest.mark.parametrize(
    ("profile", "load"),
    [
        # As many nodes for the contacts as for the gaps: more nodes once made the other problem look cheaper.
        (Profile(1.05, 5, 2, (np.pi, np.pi)), 0.47),
        (Profile(1.02, 5, 2, (np.pi, np.pi)), 0.429),
        (Profile(1.02, 5, 2, (np.pi, np.pi)), 0.4591818181818182),
        (Profile(1.13839, 5, 2, (-0.0392699, -0.19635)), 0.567597),
        # Just below a merger, where rounding at the edges of a narrow gap once looked like tension.
        (Profile(1.1509222856205743, 7, 3, (5.667210868063196, 1.3898892337626665, 0.8622012896287767)),
         0.2872381238718943 * (1 - 3e-7)),
        # At a merger, where too few nodes once made up a gap that Newton's method could not close.
        (Profile(1.02, 3, 3, (np.pi, np.pi, np.pi)), 0.19886456502870647),
    ],
)  # fmt: skip
def test_bands_of_loads_and_mergers_are_solved(profile, load):
    assert_complementary(profile, load)


@pytest.mark.parametrize(
    ("profile", "loads"),
    [
        # All waves flatten at nearly one load, and some contacts are a hundred radians of the finest wave wide.
        (Profile(1.02, 8, 4, (2.0, 5.0, 4.4, 0.44)), [1.265125, 1.31]),
        (Profile(1.000000001, 8, 4, (0.8433120740705806, 5.581511989972917, 4.431233567742661, 0.4435588386107058)),
         [1.25, 1.3]),
        # A merger of two contacts, where the gap between them would open by less than rounding.
        (Profile(1.6529435792338483, 3, 4, (np.pi - 1e-9, np.pi - 1e-9, np.pi - 1e-9, np.pi + 1e-9)),
         [4.005064139767961]),
    ],
)  # fmt: skip
def test_loads_at_which_contacts_nearly_merge(profile, loads):
    curve = patches.curve(profile, loads)
    assert curve.residual.max() < 1e-10
    assert curve.work.max() < 30


def test_a_looser_tolerance_takes_no_more_steps():
    profile, loads = Profile(1.25, 5, 4, 1.0), np.geomspace(0.7, 4.0, 3)
    tight = patches.curve(profile, loads)
    loose = patches.curve(profile, loads, tolerance=1e-6)
    assert np.all(loose.work <= tight.work)
    np.testing.assert_allclose(loose.compliance, tight.compliance, rtol=0, atol=1e-8)
    np.testing.assert_allclose(loose.resistance, tight.resistance, rtol=1e-5)


@pytest.mark.parametrize("load", [1e-300, 1e-25, 1e-20, 1e-16])
def test_light_loads_beside_the_end_of_the_period(load):
    """The crest lies 5e-8 before 0, where a position that is a period more had lost the width of a contact."""
    profile = Profile(1.0230056209055016, "7/2", 2, (8.0e-7, 6.7e-7))
    curve = patches.curve(profile, load)
    half_width = 2 * np.sqrt(load * profile.period / -profile.curvature(profile.crest[0]))  # Hertz
    assert curve.contact_fraction[0] * profile.period == pytest.approx(2 * half_width, rel=1e-6)
    # F (1 - 2 ln(pi a/L)), as the gap of a lone contact has it
    lone = load * profile.period * (1 - 2 * np.log(np.pi * half_width / profile.period))
    assert curve.indentation[0] == pytest.approx(lone, rel=1e-6)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_twin_crests_that_differ_by_rounding_are_mirrored(m):
    """Their heights differ by 1e-13, as the loads do: floats know no more than two digits of that."""
    phase = np.pi + 1e-13 * np.random.default_rng(0).uniform(-1, 1, m)
    loads = [2e-15, 6e-15]
    here, there = (patches.curve(Profile(1.5, 2, m, sign * phase), loads) for sign in (1, -1))
    np.testing.assert_allclose(here.resistance, there.resistance, rtol=1e-9)
    np.testing.assert_allclose(here.indentation, there.indentation, rtol=1e-9)


@pytest.mark.parametrize("load", [0.03, 0.7, 2.5])
def test_pressure_and_displacement_are_fourier_pairs(load):
    solution = patches.solve_load(THREE_WAVES, load)
    points = 2**14
    x = np.arange(points) / points
    p, u = np.fft.rfft(solution.pressure(x)), np.fft.rfft(solution.displacement(x))
    k = np.arange(1, 200)
    # The sampled square roots at the edges leave k^-3/2 of error.
    np.testing.assert_allclose(u[k] * k / points, p[k] / points, atol=3e-5)
    assert solution.gap(x).mean() == pytest.approx(solution.mean_gap, abs=1e-8)


def test_edges_carry_no_singularity():
    solution = patches.solve_load(THREE_WAVES, 1.0)
    s = 1e-8
    for (left, right), (at_left, at_right) in zip(solution.edges, solution.edge_strength, strict=True):
        inside = solution.pressure([left + s, right - s]) / np.sqrt(s)
        outside = solution.gap([left - 1e3 * s, right + 1e3 * s]) / (4 / 3 * np.pi * (1e3 * s) ** 1.5)
        np.testing.assert_allclose(inside, [at_left, at_right], rtol=1e-4)
        np.testing.assert_allclose(outside, [at_left, at_right], rtol=3e-2)


def test_work_is_the_elastic_energy():
    low, high = 0.02, 0.06  # without an event between
    assert patches.events(THREE_WAVES, low, high).mean_pressure.size == 0
    s, w = np.polynomial.legendre.leggauss(12)
    loads = 0.5 * (low + high) + 0.5 * (high - low) * s
    work = 0.5 * (high - low) * np.sum(w * loads * patches.curve(THREE_WAVES, loads).resistance)
    gained = elastic_energy(high) - elastic_energy(low)
    assert gained == pytest.approx(work, rel=1e-10)


def elastic_energy(load: float) -> float:
    """Half the mean of p u, by Gauss's quadrature on every contact."""
    solution = patches.solve_load(THREE_WAVES, load)
    s = np.cos(np.arange(1, 61) * (np.pi / 61))
    total = 0.0
    for centre, half_width in zip(solution.centre, solution.half_width, strict=True):
        x = centre + half_width * s
        density = solution.pressure(x) * solution.displacement(x)
        total += half_width * np.sum(density * np.sqrt((1 - s) * (1 + s))) * np.pi / 61
    return 0.5 * total


def test_resistance_is_the_derivative_of_compliance():
    step = 1e-4
    for load in (0.05, 0.7, 2.2, 4.0):
        before, _, after = patches.curve(THREE_WAVES, load * np.array([1 - step, 1, 1 + step])).compliance
        exact = patches.curve(THREE_WAVES, load).resistance[0]
        assert (after - before) / (2 * step * load) == pytest.approx(exact, rel=1e-6)


def test_compliance_is_concave_and_contact_grows():
    curve = patches.curve(THREE_WAVES, LOADS)
    assert np.all(np.diff(curve.compliance) > 0)
    assert np.all(np.diff(curve.resistance) < 0)
    assert np.all(np.diff(curve.contact_fraction) > 0)
    chord = np.diff(curve.compliance) / np.diff(LOADS)
    assert np.all((chord < curve.resistance[:-1]) & (chord > curve.resistance[1:]))
    assert curve.residual.max() < 1e-9
    print(f"40 loads: {curve.work.sum()} Newton steps")


@pytest.mark.parametrize("load", [1e-6, 0.3, 2.0])
def test_translation_and_mirror_change_nothing(load):
    phase, waves = THREE_WAVES.phase, np.array(THREE_WAVES.waves_per_period)
    shift = 0.237
    there = Profile(1.25, 5, 3, phase - 2 * np.pi * waves * shift)
    mirrored = Profile(1.25, 5, 3, -phase)
    here = patches.solve_load(THREE_WAVES, load)
    a, b, c = (patches.curve(profile, load) for profile in (THREE_WAVES, there, mirrored))
    for other in (b, c):
        assert other.indentation[0] == pytest.approx(a.indentation[0], rel=1e-11)
        assert other.resistance[0] == pytest.approx(a.resistance[0], rel=1e-9)
        assert other.contact_fraction[0] == pytest.approx(a.contact_fraction[0], rel=1e-10)
    moved = np.sort(patches.solve_load(there, load).centre % 1)
    np.testing.assert_allclose(moved, np.sort((here.centre + shift) % 1), atol=1e-11)
    turned = np.sort(patches.solve_load(mirrored, load).centre % 1)
    np.testing.assert_allclose(turned, np.sort(-here.centre % 1), atol=1e-11)


def test_tolerance_within_reach():
    with pytest.raises(ValueError, match="tolerance must lie in"):
        patches.curve(THREE_WAVES, 0.1, tolerance=1e-17)


def test_thousands_of_waves_under_a_light_load():
    """15 625 crests: few contacts, in a tenth of a second; under a heavy load hundreds, without a dense matrix."""
    profile = Profile(1.5, 5, 7, 1.0)
    light = patches.curve(profile, [1e-12, 1e-6])
    assert light.patch_count[0] == 1
    highest = -profile.curvature(profile.crest[0])
    assert light.contact_fraction[0] == pytest.approx(2 * np.sqrt(4e-12 / highest), rel=1e-6)  # Hertz
    heavy = patches.curve(profile, 1.0)
    assert heavy.patch_count[0] > 500
    assert heavy.residual[0] < 1e-10


def test_hundreds_of_contacts():
    """More than a hundred contacts agree with boundary elements on 32 points a wave within the error these state."""
    profile = Profile(1.5, 5, 5, 1.0)
    exact = patches.curve(profile, 1.0)
    elements = bem.curve(profile, 1.0, points=32 * 625, tolerance=1e-9, edges="subgrid")
    assert exact.patch_count[0] > 100
    assert abs(exact.compliance[0] - elements.compliance[0]) < elements.compliance_error[0]
    assert abs(exact.resistance[0] - elements.resistance[0]) < elements.resistance_error[0]


def test_more_waves_than_a_computer_holds():
    with pytest.raises(ValueError, match="the finest wave must fit at most"):
        patches.curve(Profile(1.5, 10**6, 3), 0.1)


# A resolved curve, gaps (1.5), contacts beside a merger, a thousand waves, and twin crests.
@pytest.mark.parametrize(
    ("profile", "loads"),
    [
        (THREE_WAVES, np.geomspace(1e-6, 1.5, 12)),
        (Profile(1.25, 5, 4, 1.0), np.geomspace(0.5, 4.0, 4)),
        (Profile(1.02, 3, 3, (np.pi, np.pi, np.pi)), [0.19886456502870647]),
        (Profile(1.7, 300, 2, (1.0, 2.0)), [0.3, 3.0]),
        (Profile(1.7249, "3/2", 5, (0, 0, 9.4e-5, 0, np.pi)), [0.0057876]),
    ],
)
def test_the_error_of_the_compliance_is_a_bound(profile, loads):
    exact = patches.curve(profile, loads, 1e-12)
    for tolerance in (1e-6, 1e-8, 1e-10):
        found = patches.curve(profile, loads, tolerance)
        assert np.all(np.abs(found.compliance - exact.compliance) <= found.compliance_error + exact.compliance_error)
        assert np.all(found.compliance_error < 100 * tolerance)
    assert np.all(exact.compliance_error < 1e-10)  # rounding, times what may lie between samples of many contacts


def test_each_condition_that_is_violated_counts_in_the_bound():
    solution = patches.solve_load(THREE_WAVES, 0.5)
    state, R = solution.state, solution.state.sensitivity[-1]
    carried = error_bound(state, Violations(0.0, 0.0), 1.0)
    assert carried < 1e-12
    assert error_bound(state, Violations(1e-5, 1e-6), 1.0) == pytest.approx(1e-5 + 1e-6 * R, abs=1e-12)
    elsewhere = state._replace(load=0.5 + 1e-4)
    exact = patches.solve_load(THREE_WAVES, 0.5 + 1e-4)
    deviation = abs(exact.mean_gap - solution.mean_gap)
    assert deviation == pytest.approx(error_bound(elsewhere, Violations(0.0, 0.0), 1.0), rel=1e-2)


def test_a_contact_beside_two_probes_that_nearly_coincide_is_found():
    """The crest between the two others lies 5e-11 beside the middle of the gap, where a probe stands as well."""
    profile = Profile(1.7594005594533377, 2, 3, (3.1415926505972407, np.pi, 0.0))
    loose, tight = (patches.curve(profile, 0.26319946630327357, tolerance) for tolerance in (1e-6, 1e-12))
    assert loose.patch_count == tight.patch_count == 3
    assert abs(loose.compliance - tight.compliance) <= loose.compliance_error


# Two crests side by side, between which the gap is widest and has no slope; minima of the gap that are narrow, and
# beside the crest, so that probes see nothing of them; a single node among the contacts of a coarse grid; and a thin
# gap under a light load, whose edges rounding moves.
@pytest.mark.parametrize(
    ("profile", "load", "contacts"),
    [
        (Profile(1.724892437284055, "3/2", 5, [0, 0, 9.370281009450643e-05, 0, np.pi]), 0.0057882, 3),
        (Profile(1.457857122522744, "5/2", 3, [0, 0, -8.79e-10]), 0.0094374859, 3),
        (Profile(1.1613856409079433, "5/2", 4, (0, np.pi, 3.1416018016584557, np.pi)), 0.002084083173835998, 3),
        (Profile(1.9114697804879395, "2", 7, (0, 0, *4 * [np.pi], 3.1415926535879355)), 0.10618670080719707, 4),
        (Profile(1.1369860985013425, "11/3", 2, (0, 1.0280190854269363e-05)), 0.004170824264919964, 2),
        (Profile(1.625151661743045, "11/3", 2, (0, 3.1415926535947984)), 0.01875830183793605, 4),
        (Profile(1.9480076505165251, 8, 3, (5.602835668827205e-09, 0, np.pi)), 0.031069906278546635, 4),
        (
            Profile(
                1.4971078338476118, 3, 7, (5.246513605799116, 4.620953514526198, 2.140217448529063, 4.131525865138026,
                                           2.822872572360879, 5.501677211714507, 2.0443309484727927),
            ),
            7.679964705543523,
            459,
        ),
        (Profile(1.25, 5, 6), 0.5, 353),
        (Profile(1.080102518396713, 4, 5, [-2.3109469589938273e-10, 0, 0, 0, np.pi]), 0.006514588790873907, None),
        (Profile(1.1082688033410402, 10, 4, [0, np.pi, 0.0035676096921934625, np.pi]), 0.00053027583758587, None),
    ],
)  # fmt: skip
def test_hard_places_against_boundary_elements(profile, load, contacts):
    """They have another set of equations, and state how far they may be off."""
    exact, grid = patches.curve(profile, load), bem.curve(profile, load, points_per_wave=64)
    assert abs(exact.compliance - grid.compliance) <= grid.compliance_error
    if contacts is not None:
        assert exact.patch_count == contacts
        assert abs(exact.resistance - grid.resistance) <= grid.resistance_error


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_a_contact_that_was_just_born_is_found_at_any_tolerance(tolerance):
    profile, load = Profile(1.0991885227757625, 6, 2, (3.1415926535897345, 0.0)), 0.08558181163342306
    exact, found = patches.curve(profile, load, 1e-12), patches.curve(profile, load, tolerance)
    assert found.patch_count == exact.patch_count
    assert found.resistance == pytest.approx(exact.resistance, rel=1e-6)


@pytest.mark.parametrize(
    ("profile", "load"),
    [
        (Profile(1.2459795552394415, 10, 4, (0.0, 0.0, -0.00015656756677498004, 0.0)), 0.0009392794684103549),
        (Profile(1.3038833346839445, 986, 2, (2.8126821861788365, 1.6687605324783774)), 0.0007448692672059101),
        (Profile(1.192044853087892, 7, 2, (np.pi, 0.00010486036015521972)), 6.975139186520863e-07),
    ],
)
def test_a_corrected_set_of_contacts_meets_the_tightest_tolerance(profile, load):
    curve = patches.curve(profile, load, 1e-12)
    assert curve.residual < 1e-10 * curve.indentation
