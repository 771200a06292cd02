"""Measured heights: what is missing in them, what is no roughness, and the end of a period."""

import re
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import weier
from benchmarks.artefacts import roughness, self_affine
from weier.surface.measured.trace import Trace

N = np.arange(200)
BASE = np.cos(2 * np.pi * N / 50) + 0.2 * np.cos(2 * np.pi * N / 9 + 1)  # um


def trace(z, **more):
    return Trace(z, 1e-3, height_unit="um", **more)


def test_roughness_of_many_kinds_has_no_jumps():
    random = np.random.default_rng(0)
    count = sum(trace(z).samples == 1000 for _ in range(3) for z in roughness(random))
    assert count == 63


@pytest.mark.parametrize("size", [1.0, 3.0])  # of the range of heights
@pytest.mark.parametrize("D", [1.05, 1.5, 1.7])
@pytest.mark.parametrize(
    ("kind", "shape"),
    [("step", [0, 1]), ("step", [0, 0.4, 1]), ("spike", [0, 1, 0]), ("spike", [0, -1, 0]), ("spike", [0, 1, 0.7, 0])],
)
def test_a_step_or_a_spike_is_refused_where_it_stands(kind, shape, D, size):
    random = np.random.default_rng(3)
    z = self_affine(1000, D, random)
    at, n = int(random.integers(10, 900)), len(shape)
    z[at : at + n] += size * np.ptp(z) * np.array(shape)
    if kind == "step":
        z[at + n :] += size * np.ptp(self_affine(1000, D, np.random.default_rng(3)))
    with pytest.raises(ValueError, match=rf"got a {kind} of .* between heights (\d+) and (\d+)") as refused:
        Trace(z, 1.0, unit="m")
    first, last = map(int, re.search(r"heights (\d+) and (\d+)", str(refused.value)).groups())
    assert at + 1 <= first < last <= at + n


def test_several_steps_are_no_roughness_either():
    x = np.arange(400) + 0.5
    with pytest.raises(ValueError, match="got a step of 2 m between heights 10 and 11"):
        Trace(np.sign(np.sin(2 * np.pi * x / 20)), 1.0, unit="m")


SENTINELS = [-9999, -99999.9999, 32767, 1e10]


@pytest.mark.parametrize("value", SENTINELS)
@pytest.mark.parametrize("places", [[100, 102], [100, 102, 150], [0, 199], [7, 8, 9, 10, 11], list(range(1, 199, 4))])
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_a_value_that_stands_for_missing_heights_is_named(value, places, tilt):
    z = BASE + tilt * N
    z[places] = value
    with pytest.raises(
        ValueError, match=rf"got {re.escape(f'{value:.9g}')} at {len(places)} of 200 places, first"
    ) as it:
        trace(z)
    assert f"height {places[0] + 1}, " in str(it.value)
    assert f"say missing_value={value:.9g}" in str(it.value)


@pytest.mark.parametrize("seed", range(5))
def test_zeros_among_heights_about_zero_are_a_value_that_stands_for_missing_heights(seed):
    gone = np.random.default_rng(seed).random(200) < 0.05
    gone[[20, 70, 120, 170]] = True
    with pytest.raises(ValueError, match=rf"got 0 at {gone.sum()} of 200 places, .*missing_value=0"):
        trace(np.where(gone, 0.0, BASE))


@pytest.mark.parametrize("dust", [-12.0, 1.5])
@pytest.mark.parametrize(
    "places", [[100], [0], [199], [100, 102], [100, 101], [0, 1], [5, 9, 14], [100, 102, 104, 106]]
)
def test_dust_is_refused_whatever_stands_beside_it(dust, places):
    z = BASE.copy()
    z[places] += dust
    with pytest.raises(
        ValueError, match=r"heights must not jump, got a (spike|step) of .* between heights (\d+)"
    ) as it:
        trace(z)
    assert int(re.search(r"heights (\d+)", str(it.value)).group(1)) in range(places[0], places[-1] + 2)


@pytest.mark.parametrize("fraction", [0.01, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("seed", range(5))
def test_random_dropouts_are_refused(fraction, seed):
    random = np.random.default_rng(seed)
    at = random.random(200) < fraction
    at[50] = True
    for spoilt in (np.where(at, BASE + 12, BASE), np.where(at, BASE + random.choice([-1, 1], 200) * 15, BASE)):
        with pytest.raises(ValueError, match="heights must"):
            trace(spoilt)


@pytest.mark.parametrize("width", [1.5, 2.0, 3.0, 6.0])
@pytest.mark.parametrize("digits", [2, 3, 16])
def test_a_groove_in_a_smooth_surface_is_roughness(width, digits):
    """Its flanks are the largest changes by far, but each has one beside it that is like it."""
    x, noise = np.arange(1000), np.random.default_rng(1).normal(size=1000)
    z = np.round(0.01 * noise - np.exp(-(((x - 500.2) / width) ** 2)), digits)
    assert trace(z).samples == 1000


MASKED = np.ma.masked_array(BASE, np.isin(N, [5, 6, 50]))
ASTROPY = SimpleNamespace(unmasked=BASE, mask=MASKED.mask)  # whose masked arrays are none of NumPy
SOME = [None if at in (5, 6, 50) else z for at, z in enumerate(BASE.tolist())]
SENTINEL = np.where(np.isin(N, [5, 6, 50]), -9999, BASE)


@pytest.mark.parametrize(
    ("z", "more"),
    [
        (MASKED, {}),
        (ASTROPY, {}),
        (MASKED.filled(np.nan), {}),
        (SOME, {}),
        (pd.Series(SOME, dtype="Float64"), {}),
        (SENTINEL, {"missing_value": -9999}),
        (SENTINEL.astype("f4"), {"missing_value": -9999.0}),
    ],
)
def test_missing_heights_are_refused_with_their_count_and_filled_where_that_is_asked_for(z, more):
    says = "^3 of 200 heights are missing, the first is height 6, at most 2 adjacent between others: say max_gap=2 to"
    with pytest.raises(ValueError, match=says):
        trace(z, **more)
    filled = trace(z, max_gap=5, **more)
    straight = np.interp(N, np.delete(N, [5, 6, 50]), np.delete(BASE, [5, 6, 50]))
    assert filled.g_0 == pytest.approx(trace(straight).g_0, rel=1e-6)
    assert filled.filled == 3
    assert filled.labels["trace_filled"] == 3
    assert "200 heights, 3 of them interpolated, over" in filled.describe()
    assert filled.digest != trace(straight).digest


def test_only_short_runs_inside_the_line_are_filled():
    z = BASE.copy()
    z[100:109] = np.nan
    for max_gap in (0, 8):
        with pytest.raises(ValueError, match=r"the first is height 101, at most 9 adjacent .* say max_gap=9 to fill"):
            trace(z, max_gap=max_gap)
    assert trace(z, max_gap=9).filled == 9
    with pytest.raises(ValueError, match="all 200 heights are missing"):
        trace(np.full(200, np.nan))
    with pytest.raises(ValueError, match="max_gap must be a whole number, at least 0, got -1"):
        trace(BASE, max_gap=-1)


def test_where_heights_are_missing_at_the_ends_the_trace_is_cut_off():
    z = BASE.copy()
    z[[0, 1, 2, 3, 4, 5, 6, 50, 199]] = np.nan
    with pytest.raises(ValueError, match=r"9 of 200 .* height 1, at most 1 adjacent between others"):
        trace(z)
    cut = trace(z, max_gap=5)
    filled = np.interp(N[7:199], N[~np.isnan(z)], z[~np.isnan(z)])
    expected = Trace(filled, 1e-3 * 192 / 200, height_unit="um")
    assert cut.filled == 1
    assert cut.samples == 192
    assert cut.lambda_0 == pytest.approx(0.96e-3, rel=1e-12)
    np.testing.assert_allclose(cut.amplitude * cut.g_0, expected.amplitude * expected.g_0, rtol=1e-9, atol=1e-18)
    with pytest.raises(ValueError, match="heights must be a whole period, got 8 that are missing at its ends"):
        trace(z, max_gap=5, ends="periodic")


@pytest.mark.parametrize("share", [0.3, 0.6, 0.8])
def test_a_code_of_most_heights_is_named(share):
    rng = np.random.default_rng(0)
    z = np.where(rng.random(400) < share, -9999.0, rng.normal(size=400).cumsum())
    with pytest.raises(ValueError, match="say missing_value=-9999"):
        Trace(z, 2e-3, height_unit="nm")


@pytest.mark.parametrize("seed", range(5))
def test_a_rough_period_that_repeats_its_first_height_is_doubted(seed):
    z = weier.gaussian(0.5, 1e-3, 5e-6, rms_height=1e-6, seed=seed).height(np.arange(400) / 400)
    with pytest.warns(UserWarning, match="first and the last of 401 heights"):
        Trace(np.append(z, z[0]), 1e-3, height_unit="um", ends="periodic")


@pytest.mark.parametrize("phase", [0.0, 0.5, 3.0])
def test_a_period_that_repeats_its_first_height_is_doubted(phase):
    def wave(n):
        return np.cos(2 * np.pi * n + phase) + 0.2 * np.cos(14 * np.pi * n)

    with pytest.warns(UserWarning, match=r"first and the last of 101 heights .* length of 100 steps") as told:
        trace(wave(np.linspace(0, 1, 101)), ends="periodic")
    assert told[0].filename == __file__
    assert trace(wave(np.arange(100) / 100), ends="periodic").samples == 100
    assert trace(wave(np.linspace(0, 1, 101)), ends="mirrored").samples == 101
    with pytest.warns(UserWarning, match="first and the last of"):
        trace(np.cos(2 * np.pi * (N + 0.5) / 200), ends="periodic")  # equal heights on both sides of a crest
    trace(np.minimum(np.cos(2 * np.pi * N / 200), 0.5), ends="periodic")
