"""The crests that heights are evaluated from, and the heights."""

import mpmath as mp
import numpy as np
import pytest

from tests.methods.patches.westergaard_states import KINDS
from weier import Profile, Trace
from weier.methods.patches.surface import (
    distances_between,
    evaluate_at,
    from_crests,
    in_order,
    intervals_between,
    make_series,
    nearest_crests,
    surface_of,
)

ROUNDING = 8 * np.finfo(float).eps  # of sums over waves, and of polynomials


def rough(waves, ends):
    heights = np.cumsum(np.random.default_rng(3).normal(size=2 * waves))
    heights -= heights[-1] * np.linspace(0, 1, heights.size)  # no jump at the end of a period
    return Trace(1e-8 * heights, 1e-3, ends=ends, unit="m")


SURFACES = {
    "trace": rough(100, "periodic"),
    "mirrored trace": rough(100, "mirrored"),
    "series": Profile(1.25, 5, 5, phases=(0, 1, 1, 1, 1)),
    "series of a long period": Profile(1.5, "5/3", 5, phases=(0, 1, 2, 3, 4)),
}


@pytest.mark.parametrize("phases", [(0.0, 0.0, 0.0), (1e-17, 0.0, 0.0), (-1e-17, 0.0, 0.0), (0.0, 1.0, 2.0)])
def test_the_nearest_crest(phases):
    """On the periodic line, with a crest at its seam or beside it, against a look at all of them."""
    heights = surface_of(Profile(1.5, 5, 3, phases)).heights
    x = np.concatenate([np.linspace(-1.2, 1.2, 97), [-1e-18, 1e-18, 1 - 1e-16]])
    apart = x[:, None] - heights.crest_position - np.rint(x[:, None] - heights.crest_position)
    crest, y = nearest_crests(heights, x)
    np.testing.assert_array_equal(np.abs(y), np.abs(apart).min(axis=1))
    np.testing.assert_array_equal(y, np.take_along_axis(apart, crest[:, None], 1)[:, 0])


def exact_sums(profile, amplitude, x):
    """The series and two derivatives, in 40 digits."""
    totals = [mp.mpf(0)] * 3
    for a, waves, phase in zip(amplitude, profile.waves_per_period, profile.phase, strict=True):
        k = 2 * mp.pi * waves / mp.mpf(profile.period)
        cosine, sine = mp.cos_sin(k * x + mp.mpf(float(phase)))
        for order, of_wave in enumerate((cosine, -k * sine, -k * k * cosine)):
            totals[order] += mp.mpf(float(a)) * of_wave
    return totals


def exact_crest(profile, amplitude, x):
    """The crest near x and its height."""
    x = mp.mpf(float(x))
    for _ in range(4):
        _, slope, curvature = exact_sums(profile, amplitude, x)
        x -= slope / curvature
    return x, exact_sums(profile, amplitude, x)[0]


def evaluated(series, crest, y):
    """The fall from the maximum and two derivatives."""
    return [evaluate_at(series.local, np.array([crest]), np.array([y]), order)[0] for order in range(3)]


@pytest.mark.parametrize("name", SURFACES)
def test_heights_near_a_crest_and_far_from_it(name, dual):
    """To rounding of the waves' own falls within half a step of the highest crest, and beyond of the waves."""
    profile = SURFACES[name]
    amplitude = -profile.full_contact_pressure if dual else profile.amplitude
    series = KINDS[dual].series(surface_of(profile))
    waves, slopes, curvatures = (np.abs(amplitude) @ series.wavenumber**n for n in range(3))
    highest = int(np.argmax(series.crest_offset))
    with mp.workdps(40):
        x, top = exact_crest(profile, amplitude, series.crest_position[highest])
        assert abs(float(top) - series.maximum) < ROUNDING * waves
        for steps in (1e-9, 0.01, -0.3, 0.499, 0.501, -2.0, 7.3, -100.6, 0.7 * series.period / series.step):
            y = steps * series.step
            height, slope, curvature = exact_sums(profile, amplitude, x + mp.mpf(y))
            exact = [float(height - top), float(slope), float(curvature)]
            if abs(steps) < 0.5:
                allowed = np.array([curvatures * y**2 / 2, curvatures * abs(y), curvatures])
            else:
                allowed = np.array([waves, slopes, curvatures]) * (1 + abs(y) * series.wavenumber[-1])
            assert np.all(np.abs(np.subtract(evaluated(series, highest, y), exact)) <= ROUNDING * allowed)
    fall, slope, curvature = evaluated(series, highest, y := 1e-150)
    assert fall == pytest.approx(curvature * y**2 / 2, rel=1e-15)
    assert slope == pytest.approx(curvature * y, rel=1e-15)


def test_twin_crests_are_distinguished_in_all_digits():
    """A coarse wave that is off by 1e-12 lifts one of two crests of the fine one over the other."""
    profile = Profile(1.5, 2, 2, (1e-12, np.pi))
    heights = surface_of(profile).heights
    with mp.workdps(40):
        left, right = (exact_crest(profile, profile.amplitude, x)[1] for x in heights.crest_position)
        np.testing.assert_allclose(heights.crest_offset, [float(left - right), 0.0], rtol=1e-14)


def test_intervals_between_others_go_round_the_period(period):
    origin, centre = np.array([0.0, 0.5, 0.5]) * period, np.array([0.1, -0.1, 0.3]) * period
    half_width = np.array([0.05, 0.1, 0.02]) * period
    np.testing.assert_allclose(
        distances_between(origin, centre, half_width, period) / period, [0.15, 0.28, 0.23], rtol=1e-12
    )
    start, middle, r = intervals_between((origin, centre, half_width), period)
    np.testing.assert_allclose((start + middle) / period, [0.225, 0.64, 0.935], rtol=1e-12)
    np.testing.assert_allclose(r / period, [0.075, 0.14, 0.115], rtol=1e-12)


def test_positions_are_counted_from_the_image_of_the_nearest_crest(period):
    series = make_series(np.array([1.0, 0.5]), [1, 2], np.array([0.0, 0.0]), period)  # crests at 0 and L/2
    x = np.array([-0.1, 0.1, 0.4, 0.93, 1.6, -1.05]) * period
    crest, origin, y = from_crests(series, x)
    np.testing.assert_allclose(origin + y, x, atol=1e-12 * period)
    np.testing.assert_allclose(origin / period, [0, 0, 0.5, 1, 1.5, -1], atol=1e-12)
    np.testing.assert_allclose(series.crest_position[crest] / period, [0, 0, 0.5, 0, 0.5, 0], atol=1e-12)
    order, turns = in_order(x, period)
    np.testing.assert_array_equal(turns / period, [-1, 0, 0, 0, 1, -2])
    np.testing.assert_array_equal(order, [1, 2, 4, 0, 3, 5])
