"""Measured over expected processor seconds of the methods."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress

import click
import numpy as np

from weier import ConvergenceError, Profile, Trace, random_phases
from weier.accuracy.measurement import measurement
from weier.accuracy.runner import Variant, run
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.methods.registry import METHODS, find_method
from weier.surface.waves import Waves

FRACTIONS = (1e-3, 1e-2, 0.1, 0.4, 0.9)  # load over full-contact load; in p_0* for infinite series
MANY = np.geomspace(FRACTIONS[0], FRACTIONS[-1], 40)
MAX_WAVES = 700  # finer surfaces are solved only under single loads
SERIES = ((1.25, 5), (1.5, 2), (1.75, 3), (1.1, 10))  # D and gamma
TRACES = (100, 400, 1600, 4000)  # waves
# further settings, measured on surfaces with few waves
SETTINGS = {
    "layer": ({"points": 6}, {"points": 100}),
    "bem": ({"tolerance": 1e-2}, {"tolerance": 1e-4}, {"points_per_wave": 64}),
    "patches": ({"tolerance": 1e-4}, {"tolerance": 1e-11}),
    "auto": ({"tolerance": 1e-2},),
}
HEADER = ("method and settings", "surfaces", "loads", "curves", "seconds", "measured/expected")


def surfaces(most: int) -> Iterator[tuple[str, Waves]]:
    """Yield finite and infinite series of random phases, and self-affine traces, of at most this many waves."""
    for D, gamma in SERIES:
        yield from (
            ("series", Profile(D, gamma, m, random_phases(m))) for m in range(1, 7) if gamma ** (m - 1) <= most
        )
        yield "m = inf", Profile(D, gamma, math.inf, random_phases(0))
    for hurst in (0.8, 0.3):
        yield from (("traces", _trace(waves, hurst)) for waves in TRACES if waves <= most)


def _trace(waves: int, hurst: float) -> Trace:
    k, random = np.arange(1, 2 * waves), np.random.default_rng(waves)
    amplitude = np.where(k <= waves, k ** -(0.5 + hurst), 0.0)
    heights = np.fft.irfft(np.concatenate([[0], amplitude * np.exp(2j * np.pi * random.random(k.size))]), 4 * waves)
    return Trace(1e-6 * heights, 4e-3, ends="periodic", unit="m")


def ratios(variant: Variant, profile: Waves) -> Iterator[tuple[int, float, float]]:
    """Yield loads, seconds and their ratio to the expected ones: the mean over single loads, then many loads."""
    full = profile.full_contact_load if math.isfinite(profile.m) else 1.0
    is_long = math.isfinite(profile.m) and profile.waves_per_period[-1] > MAX_WAVES
    for curves in (full * np.array([FRACTIONS]).T, *([] if is_long else [full * MANY[None]])):
        with suppress(ConvergenceError, ValueError):  # more waves than a method can resolve
            seconds = float(np.mean([_seconds(variant, profile, loads) for loads in curves]))
            method = find_method(variant.method)
            yield curves[0].size, seconds, seconds / method.seconds(profile, curves[0], **variant.settings)


def _seconds(variant: Variant, profile: Waves, loads: Array) -> float:
    return run(variant, profile, loads).seconds


def rows(variant: Variant, most: int) -> Iterator[list[str]]:
    """Yield rows below HEADER: one for each kind of surfaces and number of loads."""
    found: dict[tuple[str, int], list[tuple[float, float]]] = {}
    for kind, profile in surfaces(most):
        if find_method(variant.method).takes(profile):
            for loads, seconds, ratio in ratios(variant, profile):
                found.setdefault((kind, loads), []).append((seconds, ratio))
    for (kind, loads), measured in sorted(found.items()):
        ends = [f"{min(own):.2g} to {max(own):.2g}" for own in zip(*measured, strict=True)]
        yield [variant.name, kind, str(loads), str(len(measured)), *ends]


def seconds_of_start() -> float:
    """Return processor seconds of starting a process of the pipeline."""
    before = os.times()
    subprocess.run([sys.executable, "-c", "import weier.api.batch"], check=True)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


@measurement("Expected seconds")
@click.option("--most", default=TRACES[-1], help="Waves of the finest surface.")
@click.option("--methods", default=",".join(method.name for method in METHODS), help="Methods, with commas.")
def main(most: int, methods: str) -> list[str]:
    """Compare measured with expected processor seconds.

    Surfaces are series of one to six terms, infinite series, and traces of 100 to 4000 waves. Seconds are the mean
    over five single loads from 0.001 to 0.9 of full contact, and also for 40 loads with at most 700 waves. Settings
    other than the defaults are measured on series of at most 125 waves.
    """
    lines: list[list[str]] = []
    for name in methods.split(","):
        for settings in ({}, *SETTINGS.get(name, ())):
            list(rows(Variant(name, settings), 25))  # compile first
            lines += rows(Variant(name, settings), 125 if settings else most)
    return [markdown.table(HEADER, lines), f"Starting a process takes {seconds_of_start():.2g} s."]
