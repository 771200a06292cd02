"""Random roughness: height, slope and spectrum against closed sums, and its seeds."""

import numpy as np
import pytest
from scipy.special import zeta

from weier import gaussian

LENGTH, SHORTEST = 2e-3, 1e-5  # m: 200 waves


def sampled(line, points=4000):
    """Heights of one period and their slopes by differences, in m and 1."""
    z = line.g_0 * line.height(np.arange(points) / points)
    return z, (np.roll(z, -1) - z) / (LENGTH / points)


def test_without_a_rolloff_the_sums_are_those_of_zeta():
    """Of H = 1/2, a_k^2 falls as k^-2, and each wave adds the same square of the slope."""
    line = gaussian(0.5, LENGTH, SHORTEST, rms_height=4e-7, seed=3)
    z, slope = sampled(line)
    total = zeta(2) - zeta(2, 201)
    assert np.sqrt(np.mean(z**2)) == pytest.approx(4e-7, rel=1e-12)
    assert np.sqrt(np.mean(slope**2)) == pytest.approx(2 * np.pi / LENGTH * 4e-7 * np.sqrt(200 / total), rel=2e-3)
    assert line.g_0 * line.amplitude[0] == pytest.approx(4e-7 * np.sqrt(2 / total), rel=1e-12)


@pytest.mark.parametrize("hurst", [0.2, 0.8])
def test_the_spectrum_is_constant_and_falls_from_the_rolloff_to_the_cutoff(hurst):
    line = gaussian(hurst, LENGTH, SHORTEST, rolloff=LENGTH / 8, rms_slope=0.05, seed=1)
    z, slope = sampled(line)
    power = np.abs(np.fft.rfft(z)) ** 2
    assert np.sqrt(np.mean(slope**2)) == pytest.approx(0.05, rel=4e-3)
    np.testing.assert_allclose(power[1:9] / power[1], 1, rtol=1e-9)
    np.testing.assert_allclose(
        power[[16, 80, 200]] / power[8],
        [2 ** (-1 - 2 * hurst), 10 ** (-1 - 2 * hurst), 25 ** (-1 - 2 * hurst)],
        rtol=1e-8,
    )
    assert power[201:].max() < 1e-20 * power[1]
    assert (line.lambda_0, line.shortest, line.waves_per_period) == (LENGTH, SHORTEST, list(range(1, 201)))
    assert line.samples == 402


def test_a_seed_is_a_line_of_its_own_and_finer_waves_extend_it():
    lines = [gaussian(0.8, LENGTH, SHORTEST, rms_slope=0.05, seed=seed) for seed in range(200)]
    assert len({line.digest for line in lines}) == 200
    assert lines[7].digest == gaussian(0.8, LENGTH, SHORTEST, rms_slope=0.05, seed=7).digest
    np.testing.assert_allclose(lines[7].amplitude, lines[8].amplitude, rtol=1e-14)
    finer = gaussian(0.8, LENGTH, SHORTEST / 2, rms_slope=0.05, seed=7)
    np.testing.assert_allclose(np.exp(1j * finer.phase[:200]), np.exp(1j * lines[7].phase), atol=1e-12)
    phases = np.exp(1j * np.array([line.phase for line in lines]))
    assert np.abs(phases.mean()) < 4 / np.sqrt(phases.size)
    assert np.abs((phases[:, 1:] / phases[:, :-1]).mean()) < 4 / np.sqrt(phases.size)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"hurst": 1.0, "rms_slope": 0.1}, r"hurst must lie in \(0, 1\), got 1\.0"),
        ({"shortest": 1e-9, "rms_slope": 0.1}, "shortest must lie between 2e-08 and 0.002 m, got 1e-09"),
        ({}, "one of rms_height and rms_slope must be given, got both or neither"),
        ({"rms_height": 0.4}, "slope must be from 1e-07 to 10, got .* is a unit wrong"),
        ({"rms_slope": -0.1}, "rms_slope must be positive and finite, got -0.1"),
    ],
)
def test_what_is_no_roughness_is_refused(more, says):
    with pytest.raises(ValueError, match=says):
        gaussian(**{"hurst": 0.8, "length": LENGTH, "shortest": SHORTEST} | more)
