"""Bends of spectra: their likelihood, against its definition, and their shapes."""

import math
from itertools import product

import numpy as np
import pytest
import scipy

from weier.surface import bends
from weier.surface.bends import FLAT, LONG, SHARPNESS, SHORT, STEEP, Bend, Spectrum, likeliest_bend

KINDS = list(product((LONG, SHORT), (FLAT, STEEP), SHARPNESS))


def random_spectrum(law, scatter, seed=0, waves=800):
    """Waves 8, 9, ... with variances of mean law(k): of two squares of normal numbers, or of one."""
    k = np.arange(8, 8 + waves)
    normal = np.random.default_rng(seed).normal(size=(round(2 / scatter), waves))
    return Spectrum(k, law(k) * np.mean(normal**2, axis=0), 1.0, scatter)


def log_likelihood(band, S):
    """Of chi^2 variables with n = 2/scatter degrees of freedom: n P/S has the density of chi^2."""
    n = 2 / band.scatter
    return np.sum(scipy.stats.chi2(n).logpdf(n * band.variance / S) - np.log(S))


def greatest(band, q):
    """The greatest likelihood of exp(a - beta q), by a general method."""

    def negative(p):
        return -log_likelihood(band, np.exp(p[0] - p[1] * q))

    start = [float(np.log(band.variance.mean())) + 2 * q.mean(), 2.0]
    found = scipy.optimize.minimize(negative, start, method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-4})
    return -found.fun, found.x[1]


@pytest.mark.parametrize("scatter", [1.0, 2.0])
def test_gains_are_those_of_the_likelihood_by_definition(scatter):
    band = random_spectrum(lambda k: np.maximum(k, 30.0) ** -2.2, scatter)
    x = np.log(band.k)
    straight = greatest(band, x)[0]
    for side, factor, sharpness in KINDS:
        bend = Bend(side, factor, math.log(40), sharpness)
        (rated,) = bends._rated(band, [bend]) or [None]
        most, beta = greatest(band, bend.bent(x))
        if rated is None:
            assert not bends.MIN_LAW_EXPONENT < beta < bends.MAX_LAW_EXPONENT
            continue
        rare = 0 if bend.is_rolloff else bends.RARE_BEND_MARGIN
        dispersion = np.var(
            band.variance / np.exp(-beta * bend.bent(x)) / np.mean(band.variance / np.exp(-beta * bend.bent(x)))
        )
        assert rated.beta == pytest.approx(beta, abs=0.01)
        assert rated.gain == pytest.approx(
            (2 * (most - straight) - rare) / max(1, dispersion / scatter), rel=0.05, abs=0.3
        )


@pytest.mark.parametrize(("side", "factor", "sharpness"), KINDS)
def test_a_bend_is_a_law_on_one_side_and_another_slope_on_the_other(side, factor, sharpness):
    bend = Bend(side, factor, 3.0, sharpness)
    for x, slope in ((3.0 - 9 * side, 1), (3.0 + 9 * side, factor)):
        q = bend.bent(np.array([x - 1e-3, x + 1e-3]))
        assert (q[1] - q[0]) / 2e-3 == pytest.approx(slope, abs=1e-6)
    q = bend.bent(np.array([bend.end - 1e-4, bend.end + 1e-4]))
    assert (q[1] - q[0]) / 2e-4 == pytest.approx(1, abs=0.12)
    assert bend.bent(np.array([3.0 - 9 * side]))[0] == pytest.approx(3.0 - 9 * side, abs=1e-6)


@pytest.mark.parametrize("scatter", [1.0, 2.0])
def test_the_bend_of_each_kind_is_found_where_it_is(scatter):
    for side, factor, sharpness in KINDS:
        true = Bend(side, factor, math.log(240), sharpness)
        band = random_spectrum(lambda k, true=true: np.exp(-2 * true.bent(np.log(k))), scatter, waves=6400)
        found = likeliest_bend(band, 4.0)
        assert (found.side, found.factor) == (side, factor)
        assert found.place == pytest.approx(true.place, abs=math.log(2))
        assert found.beta == pytest.approx(2, abs=0.6)
        assert found.gain > bends.MIN_BEND_GAIN


@pytest.mark.parametrize(("beta", "is_law"), [(0.85, False), (0.95, True), (3.9, True), (4.2, False), (5.5, False)])
def test_laws_have_the_exponents_of_rough_surfaces(beta, is_law):
    """Self-affine ones have 1 to 3, and steps in the slope, kinks, 4; rolled off at a quarter of the band."""
    k = np.arange(8, 808)
    band = Spectrum(k, np.maximum(k, 30.0) ** -beta, 1.0, 2.0)
    rated = bends._rated(band, [Bend(LONG, FLAT, math.log(30), 8.0)])
    assert len(rated) == is_law
    assert all(bend.beta == pytest.approx(beta, abs=0.02) for bend in rated)


def test_power_laws_seldom_have_bends():
    gains = [likeliest_bend(random_spectrum(lambda k: k**-2.2, 2.0, seed), 4.0).gain for seed in range(50)]
    assert np.mean(np.array(gains) > bends.MIN_BEND_GAIN) < 0.12
    assert np.max(gains) < bends.CERTAIN_BEND_GAIN + 3


def test_bends_that_leave_no_room_for_a_law_are_refused():
    band = random_spectrum(lambda k: np.maximum(k, 400.0) ** -2.2, 1.0)
    with pytest.raises(
        ValueError, match="must be a power law from one wavelength to 4 times of it at least, got a bend"
    ):
        likeliest_bend(band, 4.0)


def test_no_bend_is_told_within_an_octave_of_the_end():
    assert likeliest_bend(random_spectrum(lambda k: np.maximum(k, 600.0) ** -2.2, 1.0), 4.0) is None


def test_a_few_lines_tell_no_bend():
    """A series of three waves has as many bends as one likes."""
    k = np.arange(8, 1000)
    variance = np.where(np.isin(k, [10, 50, 250]), k**-1.4, 0)
    found = likeliest_bend(Spectrum(k, variance, 1.0, 2.0), 4.0)
    assert found is None or found.gain < 1
