"""Measured over expected processor seconds: `python -m weier.accuracy.expected_seconds [--most WAVES]`.

The constants of `Method.seconds` come from this table, for series and traces of 25 to 12 000 waves, and m = inf.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from time import process_time

import click
import numpy as np

from weier import ConvergenceError, Profile, Trace, random_phases
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.kernels.blas import one_thread
from weier.methods.method import Method
from weier.methods.registry import find_method
from weier.pipeline.compile import compile_kernels
from weier.surface.waves import Waves

FRACTIONS = (1e-3, 1e-2, 0.1, 0.4, 0.9)  # loads over that of full contact; in p_0* for infinite series
SERIES = [(1.25, 5, (3, 4, 5, 6)), (1.5, 2, (7, 9, 11, 13)), (1.75, 3, (5, 6, 7, 8))]  # D, gamma, m
TRACES = (100, 400, 1600, 6000, 12_000)  # waves
HEADER = ("surface", "waves", "method", "seconds at 0.001 / 0.01 / 0.1 / 0.4 / 0.9 of full contact", "mean/expected")


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


def seconds_of_loads(method: Method, profile: Waves) -> Array:
    """Return processor seconds of each load, without compiling; NaN where it is not solved."""
    full = profile.full_contact_load if math.isfinite(profile.m) else 1.0
    loads = full * np.array([FRACTIONS]).T
    seconds = np.full(len(FRACTIONS), np.nan)
    for number, load in enumerate(loads):
        start = process_time()
        with suppress(ConvergenceError):
            method.solve(profile, load)
            seconds[number] = process_time() - start
    return seconds


def row(name: str, profile: Waves, method: Method) -> list[str]:
    """Return the numbers of a method on a surface, below HEADER."""
    seconds = seconds_of_loads(method, profile)
    expected = method.seconds(profile, np.ones(1))
    waves = profile.waves_per_period[-1] if math.isfinite(profile.m) else math.inf
    listed = " / ".join(f"{value:.2g}" for value in seconds)
    return [name, f"{waves:g}", method.name, listed, f"{np.nanmean(seconds) / expected:.2f}"]


@click.command()
@click.option("--most", default=TRACES[-1], show_default=True, help="Waves of the finest surface.")
@click.option("--methods", default="layer,hybrid,bem,patches", show_default=True, help="Methods, with commas.")
def main(most: int, methods: str) -> None:
    """Print the seconds of each load, and their mean ratio to the expected ones."""
    rows = []
    compile_kernels()
    with one_thread:
        for method in map(find_method, methods.split(",")):
            taken = [(what, profile) for what, profile in surfaces(most) if method.takes(profile)]
            rows += [row(what, profile, method) for what, profile in taken]
    click.echo(markdown.table(HEADER, rows))


if __name__ == "__main__":
    main()
