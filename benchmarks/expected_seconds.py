"""Measured over expected processor seconds, and the constants of the models fitted again."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import NamedTuple

import click
import numpy as np
import scipy

from weier import ConvergenceError, Profile, Trace, random_phases
from weier.accuracy.report import Page, measurement
from weier.accuracy.runner import run
from weier.accuracy.variants import Variant, by_default, variants_of
from weier.api.batch import solve_batch
from weier.data import dataset, markdown
from weier.kernels.arrays import Array
from weier.methods import bem, layer, patches
from weier.methods.method import Method
from weier.methods.registry import find_method
from weier.pipeline.compile import compile_kernels
from weier.pipeline.curves import SURFACE_SECONDS
from weier.scene import Case
from weier.surface.waves import Waves

FRACTIONS = (1e-3, 1e-2, 0.1, 0.4, 0.9)  # loads over that of full contact; in p_0* for infinite series
MANY = np.geomspace(FRACTIONS[0], FRACTIONS[-1], 40)
SERIES = [(1.25, 5, (3, 4, 5, 6)), (1.5, 2, (7, 9, 11, 14)), (1.75, 3, (5, 6, 7, 9))]  # D, gamma, m
TRACES = (100, 400, 1600, 6000, 12_000)  # waves
FEW_WAVES = 125  # of surfaces with many loads and all variants
CONSTANTS: dict[str, tuple[float, ...]] = {
    "bem": bem.SECONDS,
    "layer": layer.SECONDS,
    "patches": patches.SECONDS,
}
HEADER = ("surface", "waves", "variant", "loads", "seconds", "measured/expected")
HEADER_OF_FITS = ("method", "`SECONDS`", "measured/expected", "fitted", "measured/fitted")


class Measurement(NamedTuple):
    """Curves of one surface by one variant.

    surface : name of it
    loads : of each curve, all of one size
    seconds : processor seconds of each curve; NaN where it is not solved
    """

    surface: str
    profile: Waves
    variant: Variant
    loads: list[Array]
    seconds: Array

    def ratio(self, constants: tuple[float, ...]) -> float:
        """Return measured over expected seconds, the mean of the curves that are solved."""
        seconds, settings = find_method(self.variant.method).seconds, self.variant.settings
        expected = seconds(self.profile, self.loads[0], constants=constants, **settings)
        return float(np.nanmean(self.seconds) / expected)


def surfaces(most: int) -> Iterator[tuple[str, Waves]]:
    """Return series of random phases, infinite ones, too, and self-affine traces with a limited number of waves."""
    for D, gamma, terms in SERIES:
        for m in terms:
            if gamma ** (m - 1) <= most:
                yield f"D = {D:g}, gamma = {gamma}, m = {m}", Profile(D, gamma, m, random_phases(m))
        yield f"D = {D:g}, gamma = {gamma}, m = inf", Profile(D, gamma, math.inf, random_phases(0))
    for exponent in (0.8, 0.3):  # The exponents of the traces.
        for waves in TRACES:
            if waves <= most:
                yield f"trace, H = {exponent:g}", _trace(waves, exponent)


def _trace(waves: int, exponent: float) -> Trace:
    k, random = np.arange(1, 2 * waves), np.random.default_rng(waves)
    amplitude = np.where(k <= waves, k ** -(0.5 + exponent), 0.0)
    heights = np.fft.irfft(np.concatenate([[0], amplitude * np.exp(2j * np.pi * random.random(k.size))]), 4 * waves)
    return Trace(1e-6 * heights, 4e-3, ends="periodic", unit="m")


def measurements(name: str, profile: Waves, method: Method) -> Iterator[Measurement]:
    """Measure a method on a surface under single loads and, for few waves, under many loads and by all variants."""
    is_long = math.isfinite(profile.m) and profile.waves_per_period[-1] > FEW_WAVES
    full = profile.full_contact_load if math.isfinite(profile.m) else 1.0
    curves = [full * np.array([FRACTIONS]).T] if is_long else [full * np.array([FRACTIONS]).T, full * MANY[None]]
    others = [] if is_long else variants_of(method, profile)
    for variant, loads in product([by_default(method.name), *others], curves):
        seconds = np.array([seconds_of(variant, profile, own) for own in loads])
        yield Measurement(name, profile, variant, list(loads), seconds)


def seconds_of(variant: Variant, profile: Waves, loads: Array) -> float:
    """Return processor seconds of a curve, without compiling; NaN if it is not solved."""
    with suppress(ConvergenceError, ValueError):  # more waves than a method can resolve
        return run(variant, profile, loads).seconds
    return math.nan


def row(measured: Measurement) -> list[str]:
    """Return the numbers of a measurement, below HEADER."""
    name, profile, variant, loads, seconds = measured
    waves = profile.waves_per_period[-1] if math.isfinite(profile.m) else math.inf
    listed, ratio = " / ".join(f"{value:.2g}" for value in seconds), measured.ratio(CONSTANTS[variant.method])
    return [name, f"{waves:g}", variant.name, str(loads[0].size), listed, f"{ratio:.2f}"]


def fitted(measured: list[Measurement]) -> tuple[float, ...]:
    """Return the constants of a method with the least squares of ln(measured/expected)."""
    start = np.log(CONSTANTS[measured[0].variant.method])

    def deviations(logarithm: Array) -> Array:
        return np.log([each.ratio(tuple(np.exp(logarithm).tolist())) for each in measured])

    return tuple(np.exp(scipy.optimize.least_squares(deviations, start).x).tolist())


def row_of_fit(measured: list[Measurement]) -> list[str]:
    """Return constants of a method and those fitted, each with the range of its ratios, below HEADER_OF_FITS."""
    cells = [method := measured[0].variant.method]
    for constants in (CONSTANTS[method], fitted(measured)):
        ratios = [each.ratio(constants) for each in measured]
        cells += [", ".join(f"{value:.2g}" for value in constants), f"{min(ratios):.2f} to {max(ratios):.2f}"]
    return cells


def seconds_of_start() -> float:
    """Return processor seconds of starting a process of the pipeline."""
    before = os.times()
    subprocess.run([sys.executable, "-c", "import weier.api.batch"], check=True)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def seconds_of_case(count: int = 500) -> float:
    """Return processor seconds of a closed form of a case, with the bounds, labels and file of its batch."""
    series = [{"D": D, "gamma": 5, "m": 3, "phases": 0.0} for D in np.linspace(1.1, 1.9, count)]
    cases = [Case(parameters, ("archard",), {}) for parameters in series]
    with TemporaryDirectory() as folder:
        start = process_time()
        dataset.write(solve_batch(cases, MANY), Path(folder) / "batch.nc", "closed forms")
        return (process_time() - start) / count


@measurement("Expected seconds")
@click.option("--most", default=TRACES[-1], help="Waves of the finest surface.")
@click.option("--methods", default=",".join(CONSTANTS), help="Methods, with commas.")
def main(most: int, methods: str) -> Page:
    """Compare measured with expected processor seconds, and fit the constants of the models again.

    Series and traces of 25 to 12 000 waves, and m = inf, are solved under single loads, from 0.001 to 0.9 of full
    contact, and those of at most 125 waves as curves of 40 loads and by all variants of a method as well. The last
    table has the `SECONDS` of each method, to be pasted into its module, with the range of the ratios.
    """
    rows, fits = [], []
    compile_kernels()
    for method in map(find_method, methods.split(",")):
        taken = [(name, profile) for name, profile in surfaces(most) if method.takes(profile)]
        for surface in taken[:2]:  # loads kernels
            list(measurements(*surface, method))
        measured = [each for surface in taken for each in measurements(*surface, method)]
        solved = [each for each in measured if np.isfinite(each.seconds).any()]
        rows += [row(each) for each in solved]
        fits.append(row_of_fit(solved))
    others = (
        f"Starting a process takes {seconds_of_start():.2g} s, and describing a surface {seconds_of_case():.2g} s "
        f"(`SURFACE_SECONDS` {SURFACE_SECONDS:g})."
    )
    return Page([markdown.table(HEADER, rows), markdown.table(HEADER_OF_FITS, fits), others])
