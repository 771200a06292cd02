"""Expected seconds of a solution or a scene, with cheaper alternatives; too expensive ones are refused."""

from __future__ import annotations

from weier.api.progress import LONG
from weier.data.markdown import significant
from weier.kernels.arrays import Array
from weier.methods import registry
from weier.methods.registry import WITHIN_TOLERANCE, find_method
from weier.methods.settings import TOLERANCE
from weier.scene import Case, Scene
from weier.surface.waves import Waves

MAX_SECONDS = 1e5  # A solution that would take more than a day is refused.


def forecast(case: Case, loads: Array) -> list[str]:
    """Return a sentence for each method of a case that is expected to take longer than `LONG`.

    Raises
    ------
    ValueError
        If a method refuses its settings, or would take longer than `MAX_SECONDS`; the message names a cheaper one.
    """
    lines = []
    for name in case.methods:
        if (method := find_method(name)).takes(case.profile):
            method.check(case.profile, **case.settings.get(name, {}))
        seconds = case.seconds(name, loads)
        if seconds > MAX_SECONDS:
            raise ValueError(
                f"method must be one that takes less than {MAX_SECONDS:g} s, got {name!r}, which may take "
                f"{seconds:.0e} s for {case.profile.describe()}: {_cheaper(case.profile, loads)}"
            )
        if seconds > LONG:
            lines.append(f"{name} takes about {significant(seconds, 2)} s: {_cheaper(case.profile, loads)}")
    return lines


def forecast_scene(scene: Scene, seconds: float, count: int, cores: int) -> list[str]:
    """Return the expected seconds of this number of missing curves as lines of text; none for a short scene.

    Raises
    ------
    ValueError
        If they would exceed the limit of the scene; the message has the key that raises it.
    """
    if not count or (seconds < LONG and scene.max_seconds is None):
        return []
    curves, on = f"{count} curve{'s' * (count != 1)}", f"{cores} core{'s' * (cores > 1)}"
    line = f"{scene.name}: {curves} to solve, in about {significant(seconds, 2)} s on {on}"
    if scene.max_seconds is None or seconds <= scene.max_seconds:
        return [line]
    more = f"set max_seconds: {significant(1.2 * seconds, 2)} in the scene"
    raise ValueError(
        f"{line}, longer than {scene.max_seconds:g} s: {more}, or take a larger tolerance, fewer cases or more cores"
    )


def _cheaper(profile: Waves, loads: Array) -> str:
    """Return the methods that take less than `LONG`, and the default tolerance of `WITHIN_TOLERANCE`."""
    fast = [method.name for method in registry.METHODS if method.takes(profile)]
    fast = [name for name in fast if find_method(name).seconds(profile, loads) < LONG]
    tolerance = WITHIN_TOLERANCE.settings[TOLERANCE].default
    within = f" (within {tolerance:g} g_0)" * (WITHIN_TOLERANCE.name in fast)
    return f"choose {', '.join([*fast, ''])}fewer loads, or fewer terms or waves{within}"
