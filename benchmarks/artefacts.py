"""Lines that the checks of heights and of fits judge wrongly."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import product
from typing import Any

import click
import numpy as np
from numpy.random import Generator

from weier import Trace, fit
from weier.accuracy.measurement import measurement
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.surface import spectrum
from weier.surface.measured import artefacts

LIMITS = (
    *("SENTINEL_DEVIATIONS", "MIN_DISTINCT", "OFF_LINE_DEVIATIONS"),
    *("ABRUPT_DEVIATIONS", "FLANK_RATIO", "JUMP_FRACTION", "JUMP_OUTLIER", "JUMP_RATIO"),
)
STEPS, SPIKES = ((0, 1), (0, 0.4, 1)), ((0, 1, 0), (0, -1, 0), (0, 1, 0.7, 0))  # shapes, over the range of heights
CODES = (-9999.0, 32767.0, 0.0)
SAMPLES = 1000  # samples per line
BANDS = tuple(product((1, 4, 8), (2, 4, 32)))  # longest wavelengths in a line, and their ratio to the shortest


def power_law(random: Generator, samples: int, D: float, longest: float = 1.0, shortest: float = 2.0) -> Array:
    """Return random heights of this fractal dimension.

    The spectrum is flat for wavenumbers k < `longest` per line, and 0 for wavelengths below `shortest` samples.
    """
    k = np.arange(1, samples // 2)
    wave = np.maximum(k, longest) ** (D - 2.5) * (random.normal(size=k.size) + 1j * random.normal(size=k.size))
    return np.fft.irfft(np.append(0, np.where(k * shortest <= samples, wave, 0)), samples)


def self_affine(samples: int, D: float, random: Generator) -> Array:
    """Return random heights of this fractal dimension with a unit deviation."""
    z = power_law(random, samples, D, samples // 100)
    return np.asarray(z / z.std())


def roughness(random: Generator) -> Iterator[Array]:
    """Yield roughness of many kinds that has no jumps."""
    x = np.arange(SAMPLES)
    for D in (1.02, 1.3, 1.6, 1.99):
        z = self_affine(SAMPLES, D, random)
        yield from (z, np.minimum(z, np.quantile(z, 0.6)), np.round(10 * z), np.round(2 * z))
    yield from (random.normal(size=SAMPLES), random.laplace(size=SAMPLES).cumsum())
    yield (x % 23 / 23 - 0.5) ** 2 + 0.01 * self_affine(SAMPLES, 1.4, random)  # turned
    yield np.clip(2 * np.sin(2 * np.pi * x / 60), -1, 1)  # flat tops and flanks of several steps
    grooves = [np.exp(-(((x - random.uniform(0, SAMPLES)) / random.uniform(3, 9)) ** 2)) for _ in range(20)]
    yield -np.maximum.reduce(grooves)  # honed


def with_artefacts(random: Generator) -> Iterator[tuple[Array, str]]:
    """Yield self-affine lines with steps, spikes and codes for missing heights, each with a part of its refusal."""
    for D in (1.05, 1.5, 1.7):
        z = self_affine(SAMPLES, D, random)
        at, size = int(random.integers(10, SAMPLES - 10)), random.uniform(1, 3) * np.ptp(z)
        for shape in (*STEPS, *SPIKES):
            spoilt = z.copy()
            spoilt[at : at + len(shape)] += size * np.array(shape)
            spoilt[at + len(shape) :] += size * shape[-1]
            yield spoilt, "must not jump"
        for code in CODES:
            gone = random.random(SAMPLES) < 0.05
            yield np.where(gone, code, z), "missing_value="


def refusal(z: Array) -> str:
    """Return the message that refuses heights, in um; empty if they are taken."""
    try:
        Trace(z, 5e-6 * z.size, height_unit="um")
    except ValueError as error:
        return str(error)
    return ""


@contextmanager
def scaled(limit: str, factor: float, module: Any = artefacts) -> Iterator[None]:
    """Multiply a limit of the checks within a `with` block."""
    usual = getattr(module, limit)
    setattr(module, limit, factor * usual)
    try:
        yield
    finally:
        setattr(module, limit, usual)


def wrong(rounds: int) -> tuple[int, int]:
    """Return the numbers of refused lines of roughness, and of artefacts that are not recognised."""
    random = np.random.default_rng(0)
    refused = sum(bool(refusal(z)) for _ in range(rounds) for z in roughness(random))
    return refused, sum(why not in refusal(z) for _ in range(rounds) for z, why in with_artefacts(random))


def doubted_fits(rounds: int) -> tuple[int, int]:
    """Return the numbers of fits to roughness in which one part of the line decides, and of all fits."""
    random, found = np.random.default_rng(0), list[bool]()
    for _ in range(rounds):
        for samples, D in product((200, 1000, 4000), (1.1, 1.3, 1.5, 1.7, 1.9)):
            with warnings.catch_warnings(record=True) as caught, suppress(ValueError):  # a line may have no power law
                warnings.simplefilter("always")
                fit(Trace(self_affine(samples, D, random), 5e-6 * samples, height_unit="um"))
                found.append(any("decide on" in str(warning.message) for warning in caught))
    return sum(found), len(found)


def bent_laws(rounds: int) -> tuple[int, int]:
    """Return the number of fits to lines of a power law that are cut off at a bend, and of all fits."""
    random, found = np.random.default_rng(1), list[bool]()
    for _, samples, D in product(range(rounds), (400, 2000), (1.3, 1.5, 1.7)):
        trace = Trace(power_law(random, 4 * samples, D)[:samples], 5e-6 * samples, height_unit="um")
        with warnings.catch_warnings(action="ignore"), suppress(ValueError):  # fits may warn, or find no D
            fitted = fit(trace)
            longest, finest = trace.lambda_0 / spectrum.WAVES_IN_LENGTH, trace.lambda_0 * trace.period / trace.finest
            found.append(fitted.lambda_0 * math.sqrt(2) < 0.99 * longest or 2**fitted.m < longest / finest / 2)
    return sum(found), len(found)


def within_errors(rounds: int, longest: int, ratio: int) -> tuple[float, float, float]:
    """Return the fraction of lines with D in (1, 2), and their fractions within one and two stated errors."""
    random, off = np.random.default_rng(0), list[float]()
    for _, D in product(range(rounds), (1.2, 1.5, 1.8)):
        trace = Trace(power_law(random, 4000, D)[:1000], 5e-3, height_unit="um")
        with suppress(ValueError), warnings.catch_warnings(action="ignore"):  # as in `bent_laws`
            found = fit(trace, trace.lambda_0 / longest, trace.lambda_0 / longest / ratio)
            off.append(abs(found.D - D) / found.D_error)
    known = np.array(off)
    return len(off) / (3 * rounds), float(np.mean(known < 1)), float(np.mean(known < 2))


@measurement("Lines that are judged wrongly")
@click.option("--rounds", default=10, help="Lines of each kind.")
@click.option("--factor", default=1.5, help="Factor of the limits.")
def main(rounds: int, factor: float) -> list[str]:
    """Count lines that the checks of heights and of fits judge wrongly, with each limit scaled.

    Lines of many kinds of roughness must be taken, and self-affine lines with steps, spikes and codes for missing
    heights refused. Each limit of the checks is divided and multiplied by a factor: a limit without false refusals on
    the one side and without missed artefacts on the other lies between the two. A further table shows how well bands
    of wavelengths determine D.
    """
    limits = [["none", "", *map(str, wrong(rounds))]]
    for limit in LIMITS:
        for scale in (1 / factor, factor):
            with scaled(limit, scale):
                limits.append([limit, f"{scale:.2f}", *map(str, wrong(rounds))])
    doubted, fits = doubted_fits(rounds)
    bent, laws = bent_laws(rounds)
    with scaled("MIN_RATIO", 0.5, spectrum):
        bands = [[*map(str, band), *(f"{part:.2f}" for part in within_errors(rounds, *band))] for band in BANDS]
    band_header = ["longest waves in the line", "longest over shortest", "with a D", "within one error", "within two"]
    return [
        markdown.table(["limit", "times", "roughness refused", "artefacts not recognised"], limits),
        f"{doubted} of {fits} fits to roughness report a part of the line that decides on them.",
        f"{bent} of {laws} fits to power laws are cut off at a bend.",
        markdown.table(band_header, bands),
    ]
