"""A trace: its waves against the heights they come from, its units, files, and what it refuses."""

import re

import numpy as np
import pytest

from weier.theory.profile import Profile
from weier.theory.trace import Trace

EPS = np.finfo(float).eps
LENGTH = 4e-3  # m


def rough(samples, seed=0, D=1.4):
    """Heights of a random periodic surface whose spectrum is a power law, in m."""
    k = np.arange(1, samples // 2)
    wave = k ** (D - 2.5) * np.exp(2j * np.pi * np.random.default_rng(seed).random(k.size))
    return 1e-4 * np.fft.irfft(np.concatenate([[0], wave]), samples)


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "shaft.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


@pytest.mark.parametrize("ends", ["periodic", "mirrored"])
@pytest.mark.parametrize("samples", [200, 333])
def test_all_waves_are_the_heights(ends, samples):
    """But for the wave of two samples, which a periodic trace of an even number has."""
    z = rough(samples)
    trace = Trace(z, LENGTH, ends=ends)
    x = np.arange(samples) / samples
    line = np.polynomial.Polynomial.fit(x, z, 0 if ends == "periodic" else 1)(x)
    dropped = 0 if ends == "mirrored" or samples % 2 else abs(np.fft.rfft(z)[-1]) / samples
    off = trace.g_0 * trace.height(x) - (z - line)
    assert np.abs(off).max() <= dropped + 100 * EPS * np.abs(z).max()
    sampled = trace.sampled_height(trace.period * samples)[:samples]
    np.testing.assert_allclose(sampled, trace.height(x), atol=200 * EPS * trace.amplitude.sum(), rtol=0)


def test_a_tapered_trace_is_whole_in_its_middle_and_smooth_at_its_ends():
    z = rough(400, seed=3)
    trace = Trace(z, LENGTH, ends="tapered")
    level = Trace(z, LENGTH).height(np.arange(400) / 400) * Trace(z, LENGTH).g_0
    off = trace.height(np.arange(400) / 400) * trace.g_0 - level
    assert np.ptp(off[50:350]) < 1e-3 * np.ptp(z)  # the mean, and the wave of two samples
    assert np.ptp(trace.height([0.0, 1 - 1 / 400])) < 1e-2


def test_units_are_the_length_and_the_root_mean_square_height():
    z = rough(300)
    trace = Trace(z, LENGTH, ends="periodic", shortest=LENGTH / 40)
    assert trace.lambda_0 == LENGTH
    assert trace.waves_per_period[-1] == 40
    assert trace.m == trace.terms == 40
    assert np.sqrt(np.mean(trace.sampled_height(1000) ** 2)) == pytest.approx(1, rel=1e-12)
    kept = np.abs(np.fft.rfft(z)[1:41]) * 2 / z.size
    assert trace.g_0 == pytest.approx(np.sqrt(np.sum(kept**2) / 2), rel=1e-12)


@pytest.mark.parametrize("profile", [Profile(1.5, 5, 3, (0.3, 1.0, 2.0)), Profile(1.2, "5/2", 4, seed=3)])
def test_the_trace_of_a_series_has_its_waves(profile):
    points = 5 * profile.waves_per_period[-1]
    trace = Trace(1e-6 * profile.sampled_height(points), profile.period * 1e-3, ends="periodic")
    unit = trace.g_0 / 1e-6
    assert trace.waves_per_period == profile.waves_per_period
    rounding = 40 * EPS * profile.total_amplitude
    np.testing.assert_allclose(trace.amplitude * unit, profile.amplitude, atol=rounding, rtol=0)
    assert trace.crest[1] * unit == pytest.approx(profile.crest[1], abs=rounding)
    assert trace.crest[0] * profile.period == pytest.approx(profile.crest[0], abs=1e-7)
    # p_0* of the trace has its own height and length.
    load = trace.full_contact_load * unit / profile.period
    assert load == pytest.approx(profile.full_contact_load, rel=1e-12)


def test_files_of_one_and_two_columns(file):
    z = rough(64)
    x = np.arange(64) * 2.5
    heading = "x in um;z in um\n# of a shaft\n"
    path = file(heading + "\n".join(f"{a};{1e6 * b!r}" for a, b in zip(x.tolist(), z.tolist(), strict=True)) + "\n\n")
    two = Trace.read(path, x_unit="um", height_unit="\u00b5m")
    one = Trace.read(file("\n".join(map(repr, z.tolist()))), length=64 * 2.5e-6)
    same = Trace(z, 64 * 2.5e-6)
    assert two.lambda_0 == pytest.approx(same.lambda_0, rel=1e-14)
    np.testing.assert_allclose(two.amplitude * two.g_0, same.amplitude * same.g_0, atol=1e-19, rtol=1e-12)
    assert one.digest == same.digest
    assert one.source == two.source == "shaft.csv"
    assert "trace shaft.csv of 64 heights" in two.describe()


def test_the_digest_tells_heights_and_waves():
    z = rough(64)
    other = z.copy()
    other[7] += 1e-12
    changed = [(other, 1e-3), (z, 2e-3), (z, 1e-3, 1e-4), (z, 1e-3, None, "tapered")]
    traces = [Trace(z, 1e-3), *(Trace(*arguments) for arguments in changed)]
    assert len({each.digest for each in traces}) == len(traces)
    assert Trace(z, 1e-3, source="elsewhere").digest == traces[0].digest


COS = np.cos(2 * np.pi * np.arange(100) / 50)
STEP = np.where(np.arange(100) < 60, 0.0, 1.0) + 0.01 * COS


@pytest.mark.parametrize(
    ("heights", "length", "more", "says"),
    [
        ([0.0, 1.0, 0.0], 1.0, {}, "heights must be 16 to 1000000 numbers, got 3"),
        (np.where(np.arange(100) == 7, np.nan, COS), 1.0, {}, "heights must be finite, in m, got nan at position 7"),
        (np.ones(50), 1.0, {}, "heights must be rough, got 50 times 1 m"),
        (np.arange(50.0), 1.0, {}, "heights must be rough, got none with waves of 0.04 m or longer"),
        (COS, 1.0, {"shortest": 0.9, "ends": "periodic"}, "heights must be rough, got none with waves of 0.9 m"),
        ("shaft.csv", 1.0, {}, r"heights must be numbers, got 'shaft.csv': weier.Trace.read takes a file"),
        (COS / 10 + np.arange(100) // 34, 1.0, {}, "heights must not jump, got a step of"),
        (STEP, 1.0, {}, r"got a step of .* m between heights 60 and 61, behind x = 0.59 m: cut the trace there"),
        (np.arange(50.0), 1.0, {"ends": "periodic"}, "step of 49 m between heights 50 and 51, behind x = 0.98 m"),
        (np.broadcast_to(0.0, 10**7), 1.0, {}, "heights must be 16 to 1000000 numbers, got 10000000"),
        (COS[None], 1.0, {}, r"heights must be one list, in m, got an array of shape \(1, 100\)"),
        (COS, 0.0, {}, "length must be positive and finite, in m, got 0.0"),
        (COS, 1.0, {"shortest": 0.01}, "must lie between two steps and the length of the trace, 0.02 and 1 m"),
        (COS, 1.0, {"shortest": 2.0}, "shortest must lie between two steps"),
        (COS, 1.0, {"ends": "cut"}, "ends must be one of mirrored, periodic, tapered, got 'cut'"),
        (rough(10**6), 1.0, {}, "shortest must leave at most 100000 of the finest waves in a period"),
    ],
)
def test_what_is_no_roughness_is_refused_in_one_sentence(heights, length, more, says):
    with pytest.raises(ValueError, match=says) as refused:
        Trace(heights, length, **more)
    assert "\n" not in str(refused.value)


def rows(z, x=None):
    return "\n".join(map(str, z) if x is None else (f"{a},{b}" for a, b in zip(x, z, strict=True)))


EVEN = np.arange(100.0)
NUMBERS = "must have one or two finite numbers"


@pytest.mark.parametrize(
    ("text", "more", "says"),
    [
        ("It is rough,\nin places.\n", {}, f"line 2, {NUMBERS}, with decimal points .*, got 'in places.'"),
        ("\n\n", {}, "shaft.csv must have one or two columns of numbers, got none"),
        (b"\x89PNG\n\xff\xfe\x00", {}, f"line 2, {NUMBERS}"),
        ("1 2 3\n", {}, f"line 1, {NUMBERS}"),
        ("1 2\n3\n", {}, "shaft.csv, line 2, must have .* as many as the lines before, .* got '3'"),
        (rows(COS), {}, "shaft.csv has one column: its length must be given"),
        (rows(COS, EVEN), {"length": 1.0}, "shaft.csv has two columns, with positions: length must be left out"),
        (rows(COS, EVEN**2), {}, "positions must rise in equal steps .*, got"),
        (rows(COS, np.zeros(100)), {}, "positions must rise in equal steps .*, got"),
        (rows(COS, EVEN[::-1]), {}, "positions must rise in equal steps .*, got 99.0 at position 0"),
        ("x,z\nmm,um\n1,2\n", {}, r"line 2, .* or begin with #, got 'mm,um'"),
        ("0,5;1,25\n", {}, "shaft.csv, line 1, must have .* decimal points .* got '0,5;1,25'"),
        ("x z\n0,5\t-1,25\n", {}, r"shaft.csv, line 2, must have .* decimal points .* got '0,5\\t-1,25'"),
        ("0,5\n0,7\n", {}, "in equal steps .* decimals with points.*, got 0.0 at position 0"),
        ("0,5\n0,7\n", {"length": 1.0}, "length must be left out, and decimals must have points"),
        ("1,\n2,\n", {"length": 1.0}, "shaft.csv, line 1, must have one or two finite numbers, .* got '1,'"),
        (rows(COS, np.where(EVEN == 50, np.nan, EVEN)), {}, f"line 51, {NUMBERS}"),
        (rows(np.where(EVEN == 9, np.nan, COS), EVEN), {}, f"line 10, {NUMBERS}"),
        ("1\n" * (10**6 + 1), {"length": 1.0}, "heights must be 16 to 1000000 numbers, got 1000001"),
        (rows(COS, EVEN), {"x_unit": "inch"}, "x_unit must be one of m, mm, um, .*nm, got 'inch'"),
        (rows(COS, EVEN), {"height_unit": "A"}, "height_unit must be one of m, mm, um, .*nm, got 'A'"),
    ],
)
def test_a_file_that_is_no_trace_is_refused_in_one_sentence(file, text, more, says):
    with pytest.raises(ValueError, match=says) as refused:
        Trace.read(file(text), **more)
    assert "\n" not in str(refused.value)


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"^there is no file .*nowhere\.csv$"):
        Trace.read(tmp_path / "nowhere.csv")
    with pytest.raises(FileNotFoundError, match=rf"^there is no file {re.escape(str(tmp_path))}: that is a folder$"):
        Trace.read(tmp_path)
    with pytest.raises(ValueError, match=r"^path must be the name of a file, got 5$"):
        Trace.read(5)


def self_affine(samples, D, random):
    k = np.arange(1, samples // 2)
    wave = np.maximum(k, samples // 100) ** (D - 2.5) * (random.normal(size=k.size) + 1j * random.normal(size=k.size))
    z = np.fft.irfft(np.append(0, wave), samples)
    return z / z.std()


def surfaces(random, samples=1000):
    """Roughness of many kinds that has no jumps."""
    x = np.arange(samples)
    for D in (1.02, 1.3, 1.6, 1.99):
        z = self_affine(samples, D, random)
        yield from (z, np.minimum(z, np.quantile(z, 0.6)), np.round(10 * z))
    yield from (random.normal(size=samples), random.laplace(size=samples).cumsum())
    yield (x % 23 / 23 - 0.5) ** 2 + 0.01 * self_affine(samples, 1.4, random)  # turned
    yield np.clip(2 * np.sin(2 * np.pi * x / 60), -1, 1)  # flat tops and flanks of several steps
    grooves = [np.exp(-(((x - random.uniform(0, samples)) / random.uniform(3, 9)) ** 2)) for _ in range(20)]
    yield -np.maximum.reduce(grooves)  # honed


def test_roughness_of_many_kinds_has_no_jumps():
    random = np.random.default_rng(0)
    count = sum(Trace(z, 1.0).samples == 1000 for _ in range(10) for z in surfaces(random))
    assert count == 170


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
        Trace(z, 1.0)
    first, last = map(int, re.search(r"heights (\d+) and (\d+)", str(refused.value)).groups())
    assert at + 1 <= first < last <= at + n


def test_several_steps_are_no_roughness_either():
    x = np.arange(400) + 0.5
    with pytest.raises(ValueError, match="got a step of 2 m between heights 10 and 11"):
        Trace(np.sign(np.sin(2 * np.pi * x / 20)), 1.0)
