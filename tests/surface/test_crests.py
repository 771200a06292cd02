"""Taylor polynomials of a series against its sums, and its crests: the highest one, and all however close."""

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.special import comb

from weier import Profile
from weier.surface.crests import (
    MAX_CURVATURE,
    MAX_FOURTH,
    MAX_THIRD,
    ORDER,
    count_nodes,
    crest_heights,
    derivatives,
    expand,
    find_crests,
    highest_crest,
    move,
    phase_angle,
    sample,
)

EPS = np.finfo(float).eps


def heights_and_tensions(profile):
    """The heights, whose waves shrink, and the tensions of full contact, whose waves grow."""
    waves = profile.waves_per_period, profile.phase, profile.period
    return [(profile.amplitude, *waves), (-profile.full_contact_pressure, *waves)]


@pytest.mark.parametrize(
    ("D", "gamma", "m"),
    [
        *((D, *of) for D in (1.0001, 1.5, 1.9999) for of in ((2, 10), (3, 7), ("5/2", 5), ("6/5", 5))),
        (1.9999, "5/3", 1),
    ],
)
def test_the_highest_crest_is_that_of_far_denser_samples(D, gamma, m):
    """Which are lower by z'' dx^2/8 at most, and the highest of all that Newton's method finds on polynomials."""
    for series in heights_and_tensions(Profile(D, gamma, m, np.random.default_rng(m).uniform(0, 2 * np.pi, m))):
        x, z = highest_crest(*series)
        amplitude, waves, phase, period = series
        points = 40 * waves[-1]
        denser = sample(amplitude, waves, phase, points)
        dx = 2 * np.pi / points
        assert -1e-14 * np.abs(amplitude).sum() <= z - denser.max()
        assert z - denser.max() <= np.abs(amplitude) @ (dx * np.array(waves, float)) ** 2 / 8
        all_crests = find_crests(amplitude, waves, expand(amplitude, waves, phase))
        assert z == pytest.approx(all_crests.expansion[:, 0].max(), rel=0, abs=8 * EPS * np.abs(amplitude).sum())
        assert 0 <= x < period
        at = amplitude @ np.cos(2 * np.pi * np.array([k * x / period % 1 for k in waves]) + phase)
        assert at == pytest.approx(z, abs=1e-9 * np.abs(amplitude).sum())
        slope = np.sin(2 * np.pi * np.array([k * x / period % 1 for k in waves]) + phase) * waves * amplitude
        assert abs(slope.sum()) < 1e-9 * np.abs(amplitude) @ waves


@pytest.mark.parametrize("terms", [32, 33, 2000])
def test_the_highest_crest_of_many_waves_and_of_equal_ones(terms):
    """Among them a comb that repeats five times, whose highest crest is each of five."""
    waves, random = np.arange(1, terms + 1), np.random.default_rng(terms)
    for k, phase in ((waves, random.uniform(0, 2 * np.pi, terms)), (5 * waves, np.zeros(terms))):
        amplitude = waves**-0.7
        x, z = highest_crest(amplitude, k.tolist(), phase, 1)
        crests = find_crests(amplitude, k.tolist(), expand(amplitude, k.tolist(), phase))
        assert z == pytest.approx(crests.expansion[:, 0].max(), rel=0, abs=8 * EPS * amplitude.sum())
        assert amplitude @ np.cos(2 * np.pi * k * x + phase) == pytest.approx(z, abs=1e-9)


def test_the_highest_crest_is_exact_where_it_is_flat():
    """Four waves whose slope, curvature and third derivative vanish at x = 0, so that Newton's step is rounding."""
    random, waves, distance = np.random.default_rng(1), np.array([1, 2, 3, 5]), np.linspace(0, 1, 1001)[:, None]
    seen, flat = 0, np.linspace(-1e-4, 1e-4, 201)[:, None]
    for _ in range(400):
        phase, shift = random.uniform(0, 2 * np.pi, 4), random.uniform()
        (amplitude,) = null_space([-waves * np.sin(phase), -(waves**2) * np.cos(phase), waves**3 * np.sin(phase)]).T
        amplitude *= -np.sign(np.cos(phase) @ (amplitude * waves**4))
        if np.max(np.cos(2 * np.pi * waves * distance + phase) @ amplitude) > np.cos(phase) @ amplitude + 4 * EPS:
            continue
        _, z = highest_crest(amplitude, waves.tolist(), phase + 2 * np.pi * waves * shift, 1)
        height = np.max(np.cos(2 * np.pi * waves * flat + phase) @ amplitude)
        assert z == pytest.approx(height, rel=0, abs=8 * EPS * np.abs(amplitude).sum())
        seen += 1
    assert seen > 30


@pytest.mark.parametrize("fine", [0.1, 1e-4, 1e-10])
@pytest.mark.parametrize("long_waves", [0, 31])
def test_the_highest_crest_between_samples_is_found_beside_lower_ones_on_samples(fine, long_waves):
    """Its samples, half a step off, are lower by 0.019, the next crest, which a sample meets, by 0.019 of `fine`."""
    waves = np.append(np.arange(1, long_waves + 1), [32, 33])
    amplitude = np.append(np.full(long_waves, 1e-30), [1, fine])
    x, z = highest_crest(amplitude, waves.tolist(), -2 * np.pi * waves * 0.5 / (16 * 33), 1)
    assert z == pytest.approx(1 + fine, rel=0, abs=4 * EPS)
    assert x == pytest.approx(0.5 / (16 * 33), abs=1e-9)


@pytest.mark.parametrize("n", [1, 2, 3, 6, 12, 40])
def test_the_highest_crest_of_a_plateau(n):
    """1 - sin^2n(x/2), of n waves, which is flat to rounding about its crest, in up to an eighth of the period."""
    waves = np.arange(1, n + 1)
    amplitude, phase = -((-1.0) ** waves) * 2.0 ** (1 - 2 * n) * comb(2 * n, n - waves), 0.3 * waves
    x, z = highest_crest(amplitude, waves.tolist(), phase, 1)
    assert z == pytest.approx(amplitude.sum(), rel=0, abs=4 * EPS * np.abs(amplitude).sum())
    assert amplitude @ np.cos(2 * np.pi * waves * x + phase) == pytest.approx(z, rel=0, abs=4 * EPS)


@pytest.mark.parametrize("bumps", [1, 5])
@pytest.mark.parametrize("n", [2, 4, 5, 6, 12])
def test_each_plateau_has_a_crest(n, bumps):
    """The slope of the same plateaus is rounding, and may nowhere fall through 0, wherever they are."""
    waves = np.arange(1, n + 1)
    amplitude = -((-1.0) ** waves) * 2.0 ** (1 - 2 * n) * comb(2 * n, n - waves)
    for shift in np.random.default_rng(n).uniform(0, 1, 60):
        series = amplitude, (bumps * waves).tolist(), 2 * np.pi * waves * shift
        expansion = expand(*series)
        crests = find_crests(*series[:2], expansion)
        off = bumps * (crests.node + crests.offset) / len(expansion) + shift  # in bumps
        assert {*(np.rint(off) % bumps).tolist()} == {*(np.rint(shift + np.arange(bumps)) % bumps).tolist()}
        assert np.abs(off - np.rint(off)).max() < 0.15


@pytest.mark.parametrize(("gamma", "m"), [(np.pi, 4), (2.5, 300), (2, 40), (1000, 6)])
def test_crests_of_more_waves_than_a_computer_holds_are_refused(gamma, m):
    profile = Profile(1.5, gamma, m)
    for name in ("crest", "full_contact_load"):
        with pytest.raises(ValueError, match="among at most 1000000 waves in a period"):
            getattr(profile, name)


TRIBONACCI = np.roots([1, -1, -1, -1])[0].real  # t^3 = t^2 + t + 1


@pytest.mark.parametrize(("steeper", "count"), [(0.0, 1), (-1e-4, 1), (1e-4, 2), (1e-6, 2)])
def test_crests_are_found_where_the_curvature_vanishes(steeper, count):
    """At x = 0 the waves cancel in z'' where gamma^D solves this, and for larger D two crests stand side by side."""
    profile = Profile(np.log(TRIBONACCI) / np.log(5 / 3) + steeper, "5/3", 4, (0, 0, 0, np.pi))
    expansion = expand(profile.amplitude, profile.waves_per_period, profile.phase)
    crests = find_crests(profile.amplitude, profile.waves_per_period, expansion)
    x = (crests.node + crests.offset) * (profile.period / len(expansion))
    assert np.sum(np.abs(x - profile.period * np.rint(x / profile.period)) < 0.01) == count
    kappa = 2 * np.pi / len(expansion) * np.array(profile.waves_per_period)
    angle = [phase_angle(k, crests.node, len(expansion)) for k in profile.waves_per_period]
    theta = np.stack(angle, axis=-1) + crests.offset[:, None] * kappa + profile.phase
    assert np.abs(np.sin(theta) @ (kappa * profile.amplitude)).max() < 1e-14 * kappa @ profile.amplitude


def test_both_of_two_crests_between_two_samples_are_found():
    """Four waves with slopes of 0 at three places on 0.01 to 0.03 of the finest wave; the outer two are crests."""
    random, waves = np.random.default_rng(0), np.array([1, 2, 3, 5])
    for _ in range(300):
        middle, part, half = random.uniform(-0.02, 0.02), random.uniform(-0.1, 0.1), random.uniform(1e-3, 3e-3)
        places, phase = middle + half * np.array([-1, part, 1]), random.uniform(0, 2 * np.pi, 4)
        slopes = -waves * np.sin(2 * np.pi * waves * places[:, None] + phase)
        fourth = waves**4 * np.cos(2 * np.pi * waves * middle + phase)
        amplitude = np.linalg.solve([*slopes, fourth], [0, 0, 0, -1])
        if np.max(-np.cos(2 * np.pi * waves * places[::2, None] + phase) @ (amplitude * waves**2)) > 0:
            continue  # troughs, by waves that hardly cancel
        expansion = expand(amplitude, waves.tolist(), phase)
        crests = find_crests(amplitude, waves.tolist(), expansion)
        off = (crests.node + crests.offset) / len(expansion) - places[::2, None]
        assert np.abs(off - np.rint(off)).min(axis=1).max() < 1e-7


@pytest.mark.parametrize("distance", [1e-6, 1e-4, 2e-3, 0.05])
def test_a_crest_with_a_trough_beside_it_is_found(distance):
    """Four waves with slopes of 0 at two places on a rise, at a distance in finest waves; one of both is a crest."""
    random, waves, found = np.random.default_rng(1), np.array([1, 2, 3, 5]), 0
    for _ in range(100):
        middle, phase = random.uniform(), random.uniform(0, 2 * np.pi, 4)
        places = 2 * np.pi * waves * (middle + distance / 10 * np.array([[-1], [1]])) + phase
        third = waves**3 * np.sin(2 * np.pi * waves * middle + phase)
        amplitude = np.linalg.solve(
            [*(waves * np.sin(places)), third, [1, 0, 0, 0]], [0, 0, 1, random.uniform(-1, 1)]
        )
        crests = find_crests(amplitude, waves.tolist(), expand(amplitude, waves.tolist(), phase))
        (downward,) = np.nonzero(np.cos(places) @ (amplitude * waves**2) > 0)
        off = (crests.node + crests.offset) / count_nodes(5) - middle - distance / 10 * (2 * downward[:, None] - 1)
        found += downward.size
        assert np.abs(off - np.rint(off)).min(axis=1).max(initial=0) < 0.02 * distance
    assert found > 90


@pytest.mark.parametrize("decay", [-0.5, 0.5, 1.5])
@pytest.mark.parametrize("terms", [10, 300])
def test_all_crests_of_a_rough_trace(decay, terms):
    """As many as the sign of the slope changes at on a grid that is far finer, each between the same two points."""
    random, waves, points = np.random.default_rng(4), np.arange(1, terms + 1), 2**19
    for _ in range(10):
        amplitude, phase = waves**-decay, random.uniform(0, 2 * np.pi, terms)
        expansion = expand(amplitude, waves.tolist(), phase)
        crests = find_crests(amplitude, waves.tolist(), expansion)
        slope = -sample(amplitude * waves, waves.tolist(), phase - np.pi / 2, points)
        changes = np.flatnonzero((slope > 0) & (np.roll(slope, -1) <= 0))
        x = np.sort((crests.node + crests.offset) / len(expansion) % 1)
        np.testing.assert_array_equal(np.floor(x * points), changes)


def test_bounds_of_derivatives_are_attained_at_the_end_of_a_step():
    z = np.polynomial.Polynomial(np.random.default_rng(5).uniform(size=ORDER + 1))
    assert z.coef @ MAX_CURVATURE == pytest.approx(z.deriv(2)(0.5), rel=1e-14)
    assert z.coef @ MAX_THIRD == pytest.approx(z.deriv(3)(0.5), rel=1e-14)
    assert z.coef @ MAX_FOURTH == pytest.approx(z.deriv(4)(0.5), rel=1e-14)


def test_heights_of_crests_hold_thirty_digits_at_positions_of_fifteen():
    """Crests of one wave and of two that peak together have the sums of the amplitudes; off by 1e-9 of a wave."""
    one, two, three = ([1.0], [6], [0.0], 3), ([1.0, 0.25], [2, 10], [0.0, 0.0], 2), ([1.0], [2], [2 * np.pi / 3], 3)
    for series, crest in ((one, [0.5, 2.0]), (two, [1.0]), (three, [1.0])):
        heights = crest_heights(*map(np.array, series[:3]), series[3], np.array(crest) + 1e-9)
        assert max(abs(height - sum(series[0])) for height in heights) < 1e-28


def test_crests_of_waves_that_peak_apart_hold_thirty_digits():
    amplitude, waves, phase = np.array([1.0, 0.6]), np.array([1, 3]), np.array([0.0, 2.0])
    x, _ = highest_crest(amplitude, waves.tolist(), phase, 1)
    (height,) = crest_heights(amplitude, waves, phase, 1, np.array([x + 1e-9]))
    with mp.workdps(40):
        parts = [(mp.mpf(a), 2 * mp.pi * int(k), mp.mpf(p)) for a, k, p in zip(amplitude, waves, phase, strict=True)]
        crest = mp.findroot(lambda x: mp.fsum(a * k * mp.sin(k * x + p) for a, k, p in parts), x)
        assert abs(height - mp.fsum(a * mp.cos(k * crest + p) for a, k, p in parts)) < 1e-23


ROUNDING = 8 * np.finfo(float).eps  # of a transform, and of a polynomial

FINEST = (np.ones(1), [256], np.full(1, 0.7))  # as few nodes a wave as there may be: the largest remainder
ROUGH = (np.arange(1, 301) ** -1.3, list(range(1, 301)), np.random.default_rng(1).uniform(0, 2 * np.pi, 300))
SERIES = (5.0 ** (-0.75 * np.arange(5)), [1, 5, 25, 125, 625], np.arange(5.0))


def values(expansion, t):
    """The polynomial of each row."""
    return np.sum(expansion * t[:, None] ** np.arange(ORDER + 1), axis=1)


def sums(amplitude, waves, phase, node, t, nodes):
    """The series and two derivatives by t, in steps from nodes."""
    kappa = 2 * np.pi * np.array(waves) / nodes
    angle = 2 * np.pi / nodes * (np.array(waves) * node[:, None] % nodes) + kappa * t[:, None] + phase
    return np.cos(angle) @ amplitude, -np.sin(angle) @ (kappa * amplitude), -np.cos(angle) @ (kappa**2 * amplitude)


@pytest.mark.parametrize("series", [FINEST, ROUGH, SERIES])
def test_values_and_derivatives_as_far_as_one_step(series):
    amplitude, waves, _ = series
    table = expand(*series)
    nodes = len(table)
    assert nodes == count_nodes(waves[-1])
    assert 4 * waves[-1] <= nodes < 8 * waves[-1]
    random = np.random.default_rng(2)
    node, t = random.integers(0, nodes, 500), random.uniform(-1, 1, 500)
    exact = sums(*series, node, t, nodes)
    found = values(table[node], t), *derivatives(table[node], t)
    kappa = 2 * np.pi * np.array(waves) / nodes
    for order in range(3):
        np.testing.assert_allclose(found[order], exact[order], atol=ROUNDING * amplitude @ kappa**order, rtol=0)


def test_a_moved_polynomial_is_the_same():
    rows, t = np.random.default_rng(3).normal(size=(4, ORDER + 1)), np.array([-0.5, 0.0, 0.2, 0.5])
    s = np.array([0.3, -0.2, 0.5, -0.5])
    scale = ROUNDING * np.abs(rows).sum(axis=1)
    assert np.all(np.abs(values(move(rows, t), s) - values(rows, t + s)) < scale)
