"""The variants of a method that measurements compare: its tolerances, if it takes any, and other settings."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

from weier.methods import bem
from weier.methods.method import Method, Settings
from weier.methods.settings import TOLERANCE, defaults
from weier.surface.waves import Waves

TOLERANCES = tuple(float(f"1e-{decade}") for decade in range(1, 13))  # g_0
# settings compared in addition to tolerances, by method: the grid of the paper, meshes of half a wave
OTHER_SETTINGS: dict[str, tuple[Settings, ...]] = {
    "bem": ({"staircase": "kept", "points_per_wave": 12},),
    "layer": ({"points": 6}, {"points": 24}),
}
MAX_POINTS = 100_000  # Points per period of boundary elements; a load then takes tens of milliseconds.


class Variant(NamedTuple):
    """One competitor in a comparison: a name of at most 16 letters, a method and its settings."""

    name: str
    method: str
    settings: Settings


def by_default(method: str) -> Variant:
    """Return a method with the settings that it has by default."""
    return Variant(method, method, {})


def variants_of(method: Method, profile: Waves) -> Iterator[Variant]:
    """Yield the variants of a method for a surface to which it applies, from the coarsest; none for "auto"."""
    tolerances = TOLERANCES if TOLERANCE in defaults(method) else ()
    if tolerances and not method.numerical:
        return
    for settings in [*OTHER_SETTINGS.get(method.name, ()), *({TOLERANCE: value} for value in tolerances)] or [{}]:
        with suppress(ValueError):
            method.check(profile, **settings)
            if method is not bem.METHOD or bem.points_of(profile, **settings) <= MAX_POINTS:
                yield Variant(" ".join([method.name, *map(_short, settings.values())]), method.name, settings)


def _short(value: object) -> str:
    return f"{value:.0e}" if isinstance(value, float) else str(value)
