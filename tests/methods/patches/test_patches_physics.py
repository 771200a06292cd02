"""What any solution must obey: complementarity, energy, symmetry, and exponential convergence."""

from itertools import pairwise

import numpy as np
import pytest
import scipy
from numpy.typing import NDArray

from weier import ConvergenceError, Profile
from weier.methods import patches
from weier.methods.patches import settle
from weier.methods.patches.guess import arrange, carried_over
from weier.methods.patches.march import first
from weier.methods.patches.newton import Status
from weier.methods.patches.surface import surface_of

Array = NDArray[np.float64]

THREE_WAVES = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
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
    return profile, float(np.exp(rng.uniform(np.log(1e-8), np.log(surface_of(profile).full_load))))


@pytest.mark.parametrize("seeds", [range(40), pytest.param(range(40, 340), marks=pytest.mark.slow)], ids=len)
def test_random_cases_are_complementary(seeds):
    for seed in seeds:
        profile, load = random_case(seed)
        assert_complementary(profile, load)


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
    phase, waves = THREE_WAVES.phase, np.array(THREE_WAVES.wavenumber)
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


@pytest.mark.parametrize(("load", "counts"), [(0.05, range(4, 13)), (0.7, range(12, 29, 2))])
def test_convergence_is_exponential_in_nodes(load, counts):
    seen = surface_of(THREE_WAVES)
    state, _ = first(THREE_WAVES, seen, load, 1e-12)
    old, errors = state.segments, []
    for count in counts:
        same = np.full(old.centre.size, count)
        guess, _ = carried_over(seen, state, old.summit, old.centre, old.half_width, same)
        fewer, found = settle.newton_from(seen, guess, load, 1e-12)
        assert found.status == Status.converged
        errors.append(abs(fewer.approach / state.approach - 1) + 1e-16)
    rate = -np.polyfit(counts, np.log(errors), 1)[0]
    print(f"load {load}: error falls {np.exp(rate):.1f} times a node; {errors[0]:.0e} to {errors[-1]:.0e}")
    assert rate > 0.5
    assert errors[-1] < 1e-9


def test_contacts_and_gaps_are_one_solution():
    """The two problems, for pressure in contacts and for slope in gaps, have nothing but the profile in common."""
    seen = surface_of(THREE_WAVES)
    load = 2.5
    dual, _ = first(THREE_WAVES, seen, load, 1e-10)
    assert dual.dual
    gaps = patches.solve_load(THREE_WAVES, load)
    heights = seen.heights
    summit = np.array([np.argmin(np.abs((heights.place - x + 0.5) % 1 - 0.5)) for x in gaps.centre])
    centre = (gaps.centre - heights.place[summit] + 0.5) % 1 - 0.5
    placed, order = arrange(heights, summit, centre, gaps.half_width * 0.999, np.full(summit.size, 80))
    phi = [gaps.pressure(gaps.centre[j] + gaps.half_width[j] * placed.node[:80] * 0.999) for j in order]
    phi = np.concatenate(phi) / np.sqrt(1 - placed.node**2)
    start = settle.Guess(False, placed, phi, 0.0)
    primal, found = settle.newton_from(seen, start, load, 1e-10)
    assert found.status == Status.converged
    assert primal.approach == pytest.approx(heights.top + dual.approach, abs=1e-10)
    assert primal.sensitivity[-1] == pytest.approx(dual.sensitivity[-1], rel=1e-8)


def test_events_are_where_the_contacts_change():
    found = patches.events(THREE_WAVES, 0.3, 10.0)
    assert found.patch_count[-1] == 0
    assert np.all(np.diff(found.mean_pressure) >= 0)
    kinds = list(zip(found.mean_pressure, found.patch_count, found.birth, strict=True))
    for load, count, birth in kinds[:-1:4]:
        around = patches.curve(THREE_WAVES, load * np.array([1 - 1e-5, 1 + 1e-5])).patch_count
        assert around[1] == count
        assert around[1] - around[0] == (1 if birth else -1)


def test_events_of_symmetric_profiles_come_in_pairs():
    found = patches.events(Profile(1.25, 2, 2), 1e-3, 2.0)
    np.testing.assert_array_equal(found.birth, [True, False, False])
    np.testing.assert_array_equal(found.patch_count, [2, 1, 0])
    assert found.x[0] == pytest.approx(0.5, abs=1e-6)
    assert found.x[1] + found.x[2] == pytest.approx(1)
    merge = patches.events(Profile(1.25, 2, 2, (0.0, np.pi)), 1e-3, 1.0)
    np.testing.assert_array_equal(merge.birth, [False])


@pytest.mark.parametrize("phase", [0.0, np.pi])
def test_events_of_one_load_are_found_together(phase):
    """z is even: whatever happens beside the axis happens on both sides at once."""
    found = patches.events(Profile(1.5, 3, 3, (0.0, phase, phase)), 0.1, 1.45)
    beside = np.minimum(np.abs(found.x % 0.5), 0.5 - found.x % 0.5) > 1e-6
    load, x = found.mean_pressure[beside], found.x[beside]
    assert load.size >= 4
    np.testing.assert_allclose(load[::2], load[1::2], rtol=1e-9)
    np.testing.assert_allclose(x[::2] + x[1::2], 1, atol=1e-6)


@pytest.mark.parametrize("shift", [0.0, 1e-10, -1e-10, 1e-9, -1e-9, 1e-8])
def test_loads_on_an_event_are_solved(shift):
    found = patches.events(THREE_WAVES, 0.15, 0.35)
    assert found.mean_pressure.size >= 4
    for load, birth in zip(found.mean_pressure, found.birth, strict=True):
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


def test_a_load_of_another_size_moves_no_contact_far():
    """The tangent, drawn over 150 decades, multiplies rounding: it once sent the contact 1e50 periods away."""
    profile, loads = Profile(1.000000001, 5, 2, (1.000000001, 0.0)), [6.666586845037927e-285, 5.772493106428526e-131]
    curve = patches.curve(profile, loads)
    alone = [patches.curve(profile, load).resistance[0] for load in loads]
    np.testing.assert_allclose(curve.resistance, alone, rtol=1e-9)


def test_a_far_load_of_a_symmetric_profile_takes_few_steps():
    """Contacts born in pairs once overlapped, and asked for thousands of nodes."""
    assert patches.curve(Profile(1.5, 3, 4), np.geomspace(1e-3, 10, 8)).work.max() < 30


def test_contacts_only_grow():
    for less, more in pairwise(patches.curve(THREE_WAVES, LOADS[::3]).contact_edge):
        before, after = (edges[np.isfinite(edges)].reshape(-1, 2) for edges in (less, more))
        for left, right in before:
            assert np.any((left - after[:, 0]) % 1 + (right - left) <= after[:, 1] - after[:, 0])


@pytest.mark.parametrize("loads", [0.0, [1.0, 1.0], [2.0, 1.0], [-1.0], [np.nan]])
def test_loads_must_rise_from_zero(loads):
    with pytest.raises(ValueError, match=r"mean_pressure must (be positive|be finite|increase)"):
        patches.curve(THREE_WAVES, loads)


def test_tolerance_within_reach():
    with pytest.raises(ValueError, match="tolerance must lie in"):
        patches.curve(THREE_WAVES, 0.1, tolerance=1e-17)


def test_thousands_of_waves_under_a_light_load():
    """8000 summits: few contacts, in a tenth of a second; under a heavy load too many for a dense matrix."""
    profile = Profile(1.5, 5, 7, 1.0)
    light = patches.curve(profile, [1e-12, 1e-6])
    assert light.patch_count[0] == 1
    highest = -profile.curvature(profile.crest[0])
    assert light.contact_fraction[0] == pytest.approx(2 * np.sqrt(4e-12 / highest), rel=1e-6)  # Hertz
    with pytest.raises(ConvergenceError, match="unknowns, more than"):
        patches.curve(profile, 1.0)


def test_more_waves_than_a_computer_holds():
    with pytest.raises(ValueError, match="the finest wave must fit at most"):
        patches.curve(Profile(1.5, 10**6, 3), 0.1)


def test_what_cannot_be_solved_raises(monkeypatch):
    monkeypatch.setattr(settle, "MOST_UNKNOWNS", 20)
    with pytest.raises(ConvergenceError, match="unknowns, more than 20"):
        patches.curve(THREE_WAVES, 2.0)


def test_a_failed_certificate_raises(monkeypatch):
    monkeypatch.setattr(settle, "residual", lambda *_: 1e-3)
    with pytest.raises(ConvergenceError):
        patches.curve(THREE_WAVES, 0.1)
