"""Expected seconds of a scene; one that exceeds its limit is refused."""

from __future__ import annotations

from weier.api.progress import LONG
from weier.data.markdown import significant
from weier.scene import Scene


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
