"""A trace: its waves against the heights they come from, its units, and what it refuses."""

import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from weier import solve
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile

EPS = np.finfo(float).eps
LENGTH = 4e-3  # m


def rough(samples, seed=0, D=1.4):
    """Heights of a random periodic surface whose spectrum is a power law, in m."""
    k = np.arange(1, samples // 2)
    wave = k ** (D - 2.5) * np.exp(2j * np.pi * np.random.default_rng(seed).random(k.size))
    return 1e-4 * np.fft.irfft(np.concatenate([[0], wave]), samples)


@pytest.mark.parametrize("ends", ["periodic", "mirrored"])
@pytest.mark.parametrize("samples", [200, 333])
def test_all_waves_are_the_heights(ends, samples):
    """But for the wave of two samples, which a periodic trace of an even number has."""
    z = rough(samples)
    trace = Trace(z, LENGTH, ends=ends, unit="m")
    x = np.arange(samples) / samples
    line = np.polynomial.Polynomial.fit(x, z, 0 if ends == "periodic" else 1)(x)
    dropped = 0 if ends == "mirrored" or samples % 2 else abs(np.fft.rfft(z)[-1]) / samples
    off = trace.g_0 * trace.height(x) - (z - line)
    assert np.abs(off).max() <= dropped + 100 * EPS * np.abs(z).max()
    sampled = trace.sampled_height(trace.period * samples)[:samples]
    np.testing.assert_allclose(sampled, trace.height(x), atol=200 * EPS * trace.amplitude.sum(), rtol=0)


def test_units_are_the_length_and_the_root_mean_square_height():
    trace = Trace(rough(300), LENGTH, ends="periodic", shortest=LENGTH / 40, unit="m")
    assert (trace.lambda_0, trace.waves_per_period[-1], trace.m) == (LENGTH, 40, 40)
    assert np.sqrt(np.mean(trace.sampled_height(1000) ** 2)) == pytest.approx(1, rel=1e-12)
    kept = np.abs(np.fft.rfft(rough(300))[1:41]) * 2 / 300
    assert trace.g_0 == pytest.approx(np.sqrt(np.sum(kept**2) / 2), rel=1e-12)


@pytest.mark.parametrize("profile", [Profile(1.5, 5, 3, (0.3, 1.0, 2.0)), Profile(1.2, "5/2", 4, seed=3)])
def test_the_trace_of_a_series_has_its_waves(profile):
    points = 5 * profile.waves_per_period[-1]
    trace = Trace(1e-6 * profile.sampled_height(points), profile.period * 1e-3, ends="periodic", unit="m")
    unit = trace.g_0 / 1e-6
    assert trace.waves_per_period == profile.waves_per_period
    rounding = 40 * EPS * profile.total_amplitude
    np.testing.assert_allclose(trace.amplitude * unit, profile.amplitude, atol=rounding, rtol=0)
    assert trace.crest[1] * unit == pytest.approx(profile.crest[1], abs=rounding)
    assert trace.crest[0] * profile.period == pytest.approx(profile.crest[0], abs=1e-7)
    # p_0* of the trace has its own height and length.
    load = trace.full_contact_load * unit / profile.period
    assert load == pytest.approx(profile.full_contact_load, rel=1e-12)


def test_the_digest_tells_heights_and_waves():
    z = rough(64)
    other = z.copy()
    other[7] += 1e-12
    changed = [(other, 1e-3), (z, 2e-3), (z, 1e-3, 1e-4), (z, 1e-3, None, "periodic")]
    traces = [Trace(z, 1e-3, unit="m"), *(Trace(*arguments, unit="m") for arguments in changed)]
    assert len({trace.digest for trace in traces}) == len(traces)
    assert Trace(z, 1e-3, source="elsewhere", unit="m").digest == traces[0].digest


COS = np.cos(2 * np.pi * np.arange(100) / 50)
STEP = np.where(np.arange(100) < 60, 0.0, 1.0) + 0.01 * COS


@pytest.mark.parametrize(
    ("heights", "length", "more", "says"),
    [
        (
            np.where(np.arange(100) == 7, np.inf, COS),
            1.0,
            {},
            "heights must be finite or missing, got inf at position 7",
        ),
        (np.arange(50.0), 1.0, {}, "heights must be rough, got 50 without any but their tilt, from 0 m"),
        (COS, 1.0, {"shortest": 0.9, "ends": "periodic"}, "heights must be rough, got none with waves of 0.9 m"),
        (STEP, 1.0, {}, r"got a step of .* m between heights 60 and 61, behind x = 0.59 m: cut the trace there"),
        (np.arange(50.0), 1.0, {"ends": "periodic"}, "step of 49 m between heights 50 and 51, behind x = 0.98 m"),
        (np.broadcast_to(0.0, 10**7), 1.0, {}, "heights must be 16 to 1000000 numbers, got 10000000"),
        (COS[None], 1.0, {}, r"heights must be one list, got an array of shape \(1, 100\)"),
        (COS, 1.0, {"shortest": 0.01}, "must lie between two steps and the length of the trace, 0.02 and 1 m"),
        (COS, None, {}, "length must be given where heights have no positions: in m, or in x_unit"),
        (
            COS,
            1.0,
            {"unit": "mm", "height_unit": "m"},
            "heights must have one unit, got unit='mm' and height_unit='m'",
        ),
        (
            COS,
            LENGTH,
            {},
            "slope of at most 10, got .* with heights from -1.* to 1.* m at steps of 4e-05 m: is a unit",
        ),
        (1e-9 * COS, 1.0, {}, "slope of at least 1e-07, got .* is a unit wrong?"),
        (COS, 160.0, {}, "length must be at most 100 m, got 160 m: is a unit wrong?"),
        (
            1e-3 * COS,
            1e-3,
            {"unit": "um"},
            r"step .* must be at least 1e-10 m, .* got 1e-11 m .*: correct length, unit",
        ),
        (rough(250_000), 1.0, {}, "shortest must leave at most 100000 of the finest waves in a period"),
    ],
)
def test_what_is_no_roughness_is_refused_in_one_sentence(heights, length, more, says):
    with pytest.raises(ValueError, match=says) as refused:
        Trace(heights, length, **{"unit": "m"} | more)
    assert "\n" not in str(refused.value)


def test_a_trace_of_many_metres_is_doubted():
    """Micrometres that were read as metres have the same slope."""
    with pytest.warns(
        UserWarning, match=r"trace is 80 m long, with heights .* if a unit is wrong, correct"
    ) as warned:
        Trace(COS, 80.0, unit="m")
    assert [one.filename for one in warned] == [__file__]
    Trace(COS, 1.0, unit="m")


def test_what_is_done_to_its_waves_or_its_heights_does_not_reach_a_trace():
    z = rough(64)
    trace = Trace(z, LENGTH, unit="m")
    before = trace.height(0.3)
    z[:] = 0
    trace.amplitude[:] = 0
    trace.phase[0] += 1
    trace.waves_per_period.append(7)
    with pytest.raises(FrozenInstanceError):
        trace.shortest = 1e-4
    assert trace.height(0.3) == before
    assert len(trace.waves_per_period) == trace.m
    assert pickle.loads(pickle.dumps(trace)).height(0.3) == before


def test_a_unit_is_of_heights_and_length_or_of_one_of_them():
    z = rough(64)
    same = [
        Trace(z, LENGTH, unit="m"),
        Trace(1e3 * z, 1e3 * LENGTH, unit="mm"),
        Trace(1e6 * z, LENGTH, height_unit="um"),
        Trace(1e6 * z, 1e3 * LENGTH, height_unit="\u00b5m", x_unit="mm"),
    ]
    for trace in same:
        assert trace.lambda_0 == pytest.approx(LENGTH, rel=1e-14)
        assert trace.g_0 == pytest.approx(same[0].g_0, rel=1e-12)


def test_an_array_that_names_its_unit_needs_no_other():
    z = 1e6 * rough(64)
    same = Trace(z, LENGTH, height_unit="um")
    heights = xr.DataArray(z, dims="x", attrs={"units": "micrometer"})
    assert Trace(heights, LENGTH).digest == same.digest
    assert Trace(heights, 1e3 * LENGTH, height_unit="um", x_unit="mm").g_0 == same.g_0
    assert Trace(pd.Series(z), LENGTH, height_unit="um").digest == same.digest
    with pytest.raises(ValueError, match="heights must have one unit, got unit='m' and 'um' by itself"):
        Trace(heights, LENGTH, unit="m")
    with pytest.raises(ValueError, match=r"the unit of heights and positions must be one of m, .*, got 'V'"):
        Trace(heights.assign_attrs(units="V"), LENGTH)


def test_the_form_of_a_body_is_removed_if_that_is_asked_for_and_else_mentioned():
    """A parabola of a hundred times the roughness; the trace has as many heights as the fit has digits."""
    z, x = rough(400), np.linspace(-1, 1, 400)
    form = 100 * np.std(z) * x**2
    with pytest.warns(UserWarning, match='form of the trace, .* times as high as its roughness, .*detrend="form"'):
        curved = Trace(z + form, LENGTH, unit="m")
    assert curved.g_0 > 20 * np.std(z)
    plane, flat = (Trace(heights, LENGTH, unit="m", detrend="form") for heights in (z, z + form))
    np.testing.assert_allclose(flat.amplitude * flat.g_0, plane.amplitude * plane.g_0, atol=1e-12 * form.max())
    with pytest.warns(UserWarning, match="tilt"):
        Trace(z + 100 * np.std(z) * x, LENGTH, unit="m", detrend="mean")
    assert Trace(z, LENGTH, unit="m").detrend == "tilt"
    with pytest.raises(ValueError, match="detrend must be mean where the ends are periodic, got 'form'"):
        Trace(z, LENGTH, ends="periodic", unit="m", detrend="form")


def test_a_trace_equals_its_copy_and_no_other():
    heights = 1e-6 * np.cos(2 * np.pi * np.arange(64) / 64)
    trace = Trace(heights, 1e-3, unit="m", source="a")
    copy = pickle.loads(pickle.dumps(trace))
    assert (copy == trace, hash(copy) == hash(trace), len({trace, copy})) == (True, True, 1)
    for other in (Trace(heights, 1e-3, unit="m", source="b"), Trace(2 * heights, 1e-3, unit="m", source="a"), "a"):
        assert trace != other


def test_the_gap_of_two_bodies_is_their_series():
    """Of every other term of a series on either body: the resistance is that of the series."""
    profile = Profile(1.5, 5, 4, (0.3, 1.0, 2.0, 0.7))
    x = np.arange(1000) / 1000
    parts = [
        sum(profile.amplitude[n] * np.cos(2 * np.pi * 5**n * x + profile.phase[n]) for n in terms)
        for terms in ((0, 2), (1, 3))
    ]
    shaft, bush = (
        Trace(z, LENGTH, ends="periodic", height_unit="um", source=name) for z, name in zip(parts, "ab", strict=True)
    )
    gap = Trace.between(shaft, bush)
    unit = gap.g_0 / 1e-6
    assert gap.waves_per_period == [1, 5, 25, 125]
    np.testing.assert_allclose(gap.height(x) * unit, sum(parts), atol=1e-13)
    loads = np.array([0.05, 2.0])
    whole, ours = solve(profile, loads), solve(gap, loads / unit)
    np.testing.assert_allclose(ours.resistance, whole.resistance, rtol=1e-7)
    np.testing.assert_allclose(ours.contact_fraction, whole.contact_fraction, rtol=1e-7)
    assert gap.digest == Trace.between(bush, shaft).digest
    assert gap.digest not in (shaft.digest, bush.digest, Trace.between(shaft, shaft).digest)
    assert (gap.source, gap.lambda_0, gap.crest[1]) == ("a on b", LENGTH, pytest.approx(profile.crest[1] / unit))


def test_equal_waves_of_two_bodies_add_up_and_those_of_opposite_phase_cancel():
    """Half the height on either side is Westergaard's problem of one wave of the whole height."""
    wave = np.cos(2 * np.pi * np.arange(100) / 100)
    half, down = (
        Trace(sign * wave / 2, LENGTH, ends="mirrored", height_unit="um", detrend="mean") for sign in (1, -1)
    )
    gap = Trace.between(half, half)
    assert gap.g_0 == pytest.approx(2 * half.g_0, rel=1e-14)
    np.testing.assert_allclose(gap.amplitude, half.amplitude, rtol=1e-13)
    with pytest.raises(ValueError, match="got heights that cancel: is one of them upside down"):
        Trace.between(half, down)


@pytest.mark.parametrize(
    ("length", "samples", "more", "says"),
    [
        (2 * LENGTH, 64, {}, r"same length in m, got 0\.004 and 0\.008: read both"),
        (LENGTH, 128, {}, "same number of heights, got 64 and 128"),
        (LENGTH, 64, {"ends": "periodic"}, "same ends, got mirrored and periodic"),
        (LENGTH, 64, {"detrend": "form"}, "same detrend, got tilt and form"),
        (LENGTH, 64, {"shortest": 5e-4}, r"same shortest, got 0\.000125 and 0\.0005"),
    ],
)
def test_traces_of_another_length_step_or_end_have_no_gap(length, samples, more, says):
    with pytest.raises(ValueError, match=says):
        Trace.between(Trace(rough(64), LENGTH, unit="m"), Trace(rough(samples, 1), length, unit="m", **more))


def test_a_gap_counts_the_filled_heights_of_both():
    first, second = rough(64), rough(64, 1)
    first[[5, 6]] = second[9] = np.nan
    gap = Trace.between(*(Trace(z, LENGTH, unit="m", max_gap=5) for z in (first, second)))
    assert gap.filled == 3
    with pytest.raises(ValueError, match="first and second must be traces, got"):
        Trace.between(gap, first)


def test_positions_of_an_array_give_its_length_or_equal_steps():
    z, x = rough(200), 1e-3 * np.arange(200)
    array = xr.DataArray(z, {"x": ("x", x, {"units": "mm"})}, "x", attrs={"units": "m"})
    assert Trace(array).lambda_0 == pytest.approx(2e-4)
    with pytest.raises(ValueError, match="length must be that of 200 steps"):
        Trace(array, 3e-4)
    kept = np.arange(200) != 100
    for part in (array[kept], array.drop_attrs()[kept], array.to_series()[kept]):
        with pytest.raises(ValueError, match=r"equal steps, got 0\.101 at height 101"):
            Trace(part, 3e-4, height_unit="m")
    for same in (array.drop_attrs(), pd.Series(z), pd.Series(z, pd.date_range("2024", periods=200)), z.tolist()):
        assert Trace(same, 3e-4, unit="m") == Trace(z, 3e-4, unit="m")
