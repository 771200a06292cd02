"""The series fitted to a trace: found again where the trace is one, and unbiased on random surfaces."""

import math

import numpy as np
import pytest

from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile
from weier.surface.spectrum import fit

LAMBDA, HEIGHT = 1e-3, 2e-6  # of the coarsest wave, in m


def trace_of(profile, waves, start, ends="mirrored"):
    """So many of the coarsest waves, from a place that is no crest, on ten samples for each of the finest."""
    samples = math.ceil(10 * waves * float(profile.gamma) ** (profile.terms - 1))
    x = start + waves * np.arange(samples) / samples
    return Trace(HEIGHT * profile.height(x), waves * LAMBDA, ends=ends, unit="m")


def band(profile):
    """Each wave stands for the wavelengths within the root of gamma around its own."""
    half = math.sqrt(profile.gamma)
    return {"longest": LAMBDA * half, "shortest": LAMBDA / float(profile.gamma) ** (profile.terms - 1) / half}


@pytest.mark.parametrize("D", [1.05, 1.25, 1.5, 1.75, 1.95])
@pytest.mark.parametrize(("gamma", "m"), [("6/5", 20), ("3/2", 10), (2, 6), (5, 3)])
@pytest.mark.parametrize("waves", [20.0, 33.4])
def test_a_series_is_found_again(D, gamma, m, waves):
    """On 20 of its coarsest waves; what leaks out of waves that do not end with the trace is below 1 %."""
    profile = Profile(D, gamma, m, seed=m)
    found = fit(trace_of(profile, waves, 0.37), **band(profile), gamma=gamma)
    assert pytest.approx(D, abs=0.01) == found.D
    assert (found.gamma, found.m) == (profile.gamma, m)
    assert found.lambda_0 == pytest.approx(LAMBDA, rel=1e-12)
    assert found.g_0 == pytest.approx(HEIGHT, rel=0.05)
    assert abs(found.D - D) < found.D_error
    assert abs(found.g_0 - HEIGHT) < found.g_0_error


def test_the_ratio_that_is_asked_for_changes_no_dimension():
    profile = Profile(1.4, "3/2", 12, seed=1)
    trace = trace_of(profile, 20, 0.1)
    found = [fit(trace, **band(profile), gamma=gamma) for gamma in ("3/2", "9/4", "27/8")]
    assert [result.m for result in found] == [12, 6, 4]
    assert np.ptp([result.D for result in found]) < 1e-12
    variances = [(result.g_0 * result.profile().amplitude) ** 2 @ np.ones(result.m) for result in found]
    np.testing.assert_allclose(variances, variances[0], rtol=1e-12)


@pytest.mark.parametrize("D", [1.2, 1.8])
def test_random_surfaces_show_no_bias_and_scatter_as_stated(D):
    """Pieces of longer surfaces with normal heights, whose spectrum is flat above the longest wavelength."""
    random, length, finest, pieces = np.random.default_rng(7), 20, 32, 60
    period = 8 * length
    k = np.arange(1, 2 * period * finest + 1)
    root = np.where(k < period, 1.0, (k / period) ** (D - 2.5)) * (k <= period * finest)
    found = []
    for _ in range(pieces):
        wave = root * (random.normal(size=k.size) + 1j * random.normal(size=k.size))
        z = np.fft.irfft(np.concatenate([[0], wave]), 2 * k.size)[: k.size // 4]
        found.append(fit(Trace(z, length, 1 / finest, unit="m"), longest=1.0))
    off = np.array([result.D for result in found]) - D
    stated = np.array([result.D_error for result in found])
    assert abs(off.mean()) < 0.006 + 2 * off.std() / math.sqrt(pieces)  # 0.006 was the largest bias of 200 pieces
    assert off.std() == pytest.approx(stated.mean(), rel=3 / math.sqrt(2 * pieces))
    assert np.mean(np.abs(off) < 2 * stated) > 0.95 - 3 * math.sqrt(0.05 / pieces)


def test_the_fit_gives_a_profile():
    profile = Profile(1.5, 2, 6, seed=2)
    found = fit(trace_of(profile, 25, 0.2), **band(profile))
    assert found.profile(seed=4).describe_with_phases().endswith("m = 6, seed 4")
    assert math.isinf(found.profile(m=math.inf).m)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"shortest": 1e-6}, "shortest must be at least that of the trace, .* m, got 1e-06"),
        ({"longest": 2e-5}, "longest must lie between .* m, 4 and gamma times the shortest wavelength, and"),
        ({"longest": 1.0}, "longest must lie between"),
        ({"gamma": 1}, "gamma must exceed 1"),
        ({"gamma": 1000}, "longest must lie between .* m, 4 and gamma times the shortest wavelength"),
    ],
)
def test_bands_that_tell_no_slope_are_refused(more, says):
    trace = trace_of(Profile(1.5, 2, 6), 20, 0.3)
    with pytest.raises(ValueError, match=says):
        fit(trace, **more)


def power_law(D, longest, shortest, seed=3, samples=4000):
    """Heights of a random surface, in m at steps of 1 um, that has no waves below or beyond two wavelengths."""
    k = np.arange(1, samples // 2)
    wavelength = 1e-6 * samples / k
    random = np.random.default_rng(seed)
    waves = k ** (D - 2.5) * (random.normal(size=k.size) + 1j * random.normal(size=k.size))
    return 1e-4 * np.fft.irfft(
        np.append(0, np.where((wavelength >= shortest) & (wavelength <= longest), waves, 0)), samples
    )


def test_the_shortest_wavelength_that_a_trace_was_cut_off_at_is_in_its_band():
    """No whole number of waves has just this length."""
    z = power_law(1.4, 1, 0)
    cut = Trace(z, 4e-3, shortest=1.7e-5, unit="m")
    assert cut.lambda_0 * cut.period / cut.finest > 1.7e-5
    found = fit(cut, longest=4e-4, shortest=1.7e-5)
    assert pytest.approx(fit(cut, longest=4e-4).D, abs=0.01) == found.D
    assert pytest.approx(fit(Trace(z, 4e-3, unit="m"), longest=4e-4, shortest=1.7e-5).D, abs=0.01) == found.D
    with pytest.raises(ValueError, match=r"shortest must be at least that of the trace, 1.7e-05 m, got 1.6e-05"):
        fit(cut, longest=4e-4, shortest=1.6e-5)


@pytest.mark.parametrize("ends", ["mirrored", "tapered"])
@pytest.mark.parametrize("seed", range(4))
def test_a_band_without_power_is_refused_and_the_right_one_is_named(ends, seed):
    trace = Trace(power_law(1.4, 4e-4, 2e-5, seed), 4e-3, ends=ends, unit="m")
    right = fit(trace, longest=4e-4, shortest=2e-5)
    assert abs(right.D - 1.4) < 3 * right.D_error
    with pytest.raises(ValueError, match=r"got none of waves shorter than .* m: take shortest=") as short:
        fit(trace, longest=4e-4)
    assert float(str(short.value).partition("shortest=")[2]) == pytest.approx(2e-5, rel=0.2)
    with pytest.raises(ValueError, match=r"got none of waves longer than .* m: take longest=") as long:
        fit(trace, longest=4e-3, shortest=2e-5)
    # What leaks out of the waves of a trace that does not repeat blurs the longest ones.
    assert 3e-4 < float(str(long.value).partition("longest=")[2]) < 2e-3
    with pytest.raises(ValueError, match=r"got none of waves shorter than"):
        fit(trace, longest=1.4e-5, shortest=2.5e-6)


def test_what_is_no_power_law_is_refused():
    noise = 1e-3 * np.random.default_rng(0).normal(size=2000)
    with pytest.raises(ValueError, match="the spectrum must fall as k\\^-beta with beta between 1 and 3, got"):
        fit(Trace(noise, 1.0, unit="m"))
