"""What any solution must obey: complementarity, symmetry, and the error that it states."""

import numpy as np
import pytest
import scipy

from tests.hard_series import hard_series
from tests.methods.patches.westergaard_states import KINDS
from tests.profiles import THREE_WAVES
from weier import ConvergenceError, Profile
from weier.kernels.arrays import Array
from weier.methods import bem, patches, westergaard
from weier.methods.patches import solver, start
from weier.methods.patches.surface import surface_of


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


@hard_series("bands_and_mergers")
def test_bands_of_loads_and_mergers_are_solved(profile, loads):
    for load in loads:
        assert_complementary(profile, load)


@hard_series("slow_or_unsolved")
def test_hard_loads_take_few_steps(profile, loads):
    curve = patches.curve(profile, loads)
    assert curve.residual.max() < 1e-10
    assert curve.work.max() < 30
    assert curve.compliance_error.max() < 1e-6


@pytest.mark.parametrize(
    ("profile", "loads"),
    [
        # The crest lies 5e-8 before 0, where a position that is a period more had lost the width of a contact.
        (Profile(1.0230056209055016, "7/2", 2, (8.0e-7, 6.7e-7)), [1e-300, 1e-25, 1e-20, 1e-16]),
        (Profile(1.5, 5, 7, 1.0), [1e-12]),  # one of 15 625 crests
    ],
)
def test_light_loads_have_one_contact_of_hertz(profile, loads):
    """Its indentation is F (1 - 2 ln(pi a/L)), as the gap of a lone contact has it."""
    curve, force, L = patches.curve(profile, loads), np.array(loads) * profile.period, profile.period
    half_width = 2 * np.sqrt(force / -profile.curvature(profile.crest[0]))
    np.testing.assert_array_equal(curve.patch_count, 1)
    np.testing.assert_allclose(curve.contact_fraction * L, 2 * half_width, rtol=1e-6)
    np.testing.assert_allclose(curve.indentation, force * (1 - 2 * np.log(np.pi * half_width / L)), rtol=1e-6)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_twin_crests_that_differ_by_rounding_are_mirrored(m):
    """Their heights differ by 1e-13, as the loads do: floats know no more than two digits of that."""
    phase = np.pi + 1e-13 * np.random.default_rng(0).uniform(-1, 1, m)
    loads = [2e-15, 6e-15]
    here, there = (patches.curve(Profile(1.5, 2, m, sign * phase), loads) for sign in (1, -1))
    np.testing.assert_allclose(here.resistance, there.resistance, rtol=1e-9)
    np.testing.assert_allclose(here.indentation, there.indentation, rtol=1e-9)


# Between births and mergers of its contacts, at 0.0767, 0.196, 0.549, 0.891, 1.639 and 2.002 p_0*
@pytest.mark.parametrize("interval", [(0.01, 0.07), (0.22, 0.5), (0.95, 1.5), (2.1, 2.47)])
def test_the_elastic_energy_is_the_work_of_the_load_and_that_of_the_fields(interval):
    """U = p h - int h dp, by Gauss's quadrature in ln p; and <p u>/2 from pressures and displacements."""
    profile = Profile(1.25, 5, 2, 1.0)
    node, weight = np.polynomial.legendre.leggauss(20)
    start, length = np.log(interval[0]), np.log(interval[1] / interval[0])
    loads = np.exp(start + (node + 1) / 2 * length)
    ends = patches.curve(profile, interval, 1e-12)
    h = patches.curve(profile, loads, 1e-12).compliance
    work = np.diff(interval * ends.compliance)[0] - length / 2 * weight @ (loads * h)
    assert np.diff(ends.elastic_energy)[0] == pytest.approx(work, rel=1e-10)
    x = np.linspace(0, 1, 20001)[:-1]
    for load, energy in zip(interval, ends.elastic_energy, strict=True):
        found = patches.solve_load(profile, load, 1e-12)
        assert np.mean(found.pressure(x) * found.displacement(x)) / 2 == pytest.approx(energy, rel=1e-4)


def test_the_elastic_energy_of_one_wave_is_westergaards_and_of_full_contact_that_of_the_waves():
    loads = np.array([1e-100, 1e-8, 0.01, 0.3, 0.7, 0.999, 1.0, 2.0])
    one = patches.curve(Profile(1.5, 3, 1), loads, 1e-12)
    np.testing.assert_allclose(one.elastic_energy, westergaard.elastic_energy(loads), rtol=1e-12)
    full = patches.curve(THREE_WAVES, [100.0])
    g, k = THREE_WAVES.amplitude, np.array(THREE_WAVES.waves_per_period) / THREE_WAVES.period
    assert full.elastic_energy[0] == pytest.approx(np.sum(g**2 * k) / 4, rel=1e-14)


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


@pytest.mark.second_attempt
def test_a_bound_beyond_the_tolerance_is_no_answer_and_the_least_one_is():
    """A hundred contacts on a period of 100 lambda_0, where rounding of the sums exceeds 1e-13."""
    profile = Profile(1.45, "11/10", 3, 1.0)
    with pytest.raises(
        ConvergenceError, match=r"known to .* because of rounding, not to the tolerance of 1e-13: take .* or more"
    ) as error:
        patches.curve(profile, [0.76], tolerance=1e-13)
    least = float(str(error.value).split("take ")[1].split()[0])
    assert patches.curve(profile, [0.76], tolerance=least).compliance_error[0] <= least < 1e-11


@hard_series("found_at_any_tolerance")
def test_any_tolerance_is_kept(profile, loads):
    """The error of the compliance is a bound, and the resistance is within its estimate."""
    exact = patches.curve(profile, loads, 1e-11)
    assert np.all(exact.residual < 1e-10 * exact.indentation)
    for tolerance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10):
        found = patches.curve(profile, loads, tolerance)
        assert np.all(np.abs(found.compliance - exact.compliance) <= found.compliance_error + exact.compliance_error)
        assert np.all(found.compliance_error <= tolerance)
        assert np.all(np.abs(found.resistance - exact.resistance) <= found.resistance_error + exact.resistance_error)
        if tolerance == 1e-10:  # with looser ones, a gap or a contact may be left out that opens or overlaps by less
            np.testing.assert_array_equal(found.patch_count, exact.patch_count)


def test_a_gap_too_narrow_to_be_solved_for_goes_on_as_wider_ones_do():
    """Below a merger, the gap's width squared is in proportion to the load that is missing, as its tension is."""
    profile, merger = Profile(1.4197054193913707, "5/2", 2, (6.120992375943766, 5.640274757851748)), 0.622008326568
    states = patches.solve_loads(profile, merger * (1 - np.array([10**-4.5, 10**-7.5])))
    assert [solution.state.cracks.contact.size for solution in states] == [0, 1]
    of_gap = [
        (solution.edges[2, 0] - solution.edges[1, 1], *solution.edge_strength[[1, 2], [1, 0]]) for solution in states
    ]
    assert np.divide(*of_gap) == pytest.approx(10 ** np.array([1.5, 2.25, 2.25]), rel=1e-2)


@hard_series("against_boundary_elements")
def test_hard_places_against_boundary_elements(profile, loads, contacts):
    """They have another set of equations, and state how far they may be off."""
    exact, grid = patches.curve(profile, loads), bem.curve(profile, loads)
    assert abs(exact.compliance - grid.compliance) <= grid.compliance_error
    if contacts is not None:
        assert exact.patch_count == contacts
        assert abs(exact.resistance - grid.resistance) <= grid.resistance_error


@hard_series("light_contacts")
def test_the_resistance_beside_a_birth_is_within_its_error(profile, load, R, fraction):
    """Guesses have too many contacts or too few, so that residuals are small when the lightest is not yet known."""
    found = patches.curve(profile, [load])
    assert abs(found.resistance[0] - R) < found.resistance_error[0] < fraction * R


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-10])
def test_the_resistance_of_one_wave_is_within_its_error_near_full_contact(tolerance):
    """Edges are right there to far more digits than the tangent pressure: errors come from its truncation."""
    loads = np.linspace(0.8, 0.95, 31)
    found = patches.curve(Profile(1.25, 5, 1), loads, tolerance)
    error = abs(found.resistance + np.log(loads))  # (13)
    assert np.all(error <= found.resistance_error)
    assert np.median(found.resistance_error) < 1e-5


@pytest.mark.parametrize(("load", "dual"), [(0.01, False), (0.4, False), (2.4, True), (3.0, True)])
def test_far_from_births_no_contact_adds_to_the_error_of_the_resistance(load, dual):
    found = patches.curve(THREE_WAVES, [load])
    R, error = found.resistance[0], found.resistance_error[0]
    assert patches.solve_load(THREE_WAVES, load).state.kind is KINDS[dual]
    assert error < 1e-9 * max(R, 1)


@pytest.mark.parametrize("shift", [0.0, 1e-10, -1e-10, 1e-9, -1e-9, 1e-8])
def test_loads_on_an_event_are_solved(shift):
    events = patches.events(THREE_WAVES, 0.15, 0.35)
    assert events.mean_pressure.size >= 4
    for load, birth in zip(events.mean_pressure, events.birth, strict=True):
        below, at, above = patches.curve(THREE_WAVES, load * np.array([1 - 1e-4, 1 + shift, 1 + 1e-4])).resistance
        assert below > at > above
        # At a birth dh/dp falls like 1/ln of the distance; at a merger it bends.
        assert below - above < (0.3 if birth else 1e-3) * at


@pytest.mark.parametrize("loads", [[1e-300, 1e-200], [1e-300, 1e300]])
def test_loads_of_any_size(loads):
    curve = patches.curve(THREE_WAVES, loads)
    assert np.all(np.isfinite(curve.compliance))
    with pytest.raises(ValueError, match="must be at least 1e-300"):
        patches.curve(THREE_WAVES, [1e-308, *loads])


@pytest.mark.second_attempt
@pytest.mark.parametrize(
    ("tolerance", "expected"), [(1e-8, [1e-8, 1e-9]), (2e-12, [2e-12, 1e-12]), (1e-12, [1e-12, 1e-10])]
)
def test_a_second_attempt_is_tighter_or_looser_if_rounding_limits_it_and_the_last(tolerance, expected, monkeypatch):
    """The first one fails, and then both."""
    starts, tried, real = start.Starts(Profile(1.5, 3, 1), tolerance), [], solver.solve_in_stages

    def failing(surface, guess, tolerance, accepted):
        tried.append(tolerance)
        if len(tried) == 1 or len(tried) > 2:
            raise solver.ConvergenceError("it fails")
        return real(surface, guess, tolerance, accepted)

    monkeypatch.setattr(solver, "solve_in_stages", failing)
    assert solver.solve_state(starts, 0.3)[0].attempts == 2
    assert tried == pytest.approx(expected, rel=1e-15, abs=0)
    with pytest.raises(solver.ConvergenceError, match="it fails"):
        solver.solve_state(starts, 0.3)
    assert len(tried) == 4
