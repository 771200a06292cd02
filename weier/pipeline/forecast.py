"""Forecasts of the cost of a solution or a scene, with cheaper alternatives; too expensive ones are refused."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from weier.kernels.arrays import Array
from weier.methods import registry
from weier.methods.errors import OutOfReachError
from weier.methods.planned.plan import TOLERANCE
from weier.methods.registry import PLANNED, find_method
from weier.pipeline.batches import Missing
from weier.pipeline.plan import plan
from weier.scene import Case, Scene
from weier.surface.profile import Profile
from weier.surface.waves import Waves
from weier.tables import significant

LONG = 30.0  # seconds: shorter solutions need no announcement.
MAX_SECONDS = 1e5  # A solution of more than a day is refused. Explicit settings, whose cost is unknown, are not.
MAX_SCENE_SECONDS = 600.0  # By default, a scene with plans may take ten minutes.
MAX_LISTED = 10  # At most so many cases without a plan are listed, since the others have the same reasons.


def forecast(case: Case, loads: Array) -> list[str]:
    """A sentence for each method of a case that its cost model puts above `LONG` at its default settings.

    Raises
    ------
    ValueError
        If a method would take longer than `MAX_SECONDS`; the message names a cheaper one.
    """
    lines = []
    for name in case.methods:
        method = find_method(name)
        if name in case.settings or not method.takes(case.profile):
            continue
        seconds = method.seconds(case.profile, loads)
        if seconds > MAX_SECONDS:
            raise ValueError(
                f"method must be one that takes less than {MAX_SECONDS:g} s, got {name!r}, which may take "
                f"{seconds:.0e} s for {case.profile.describe()}: {_cheaper(case.profile, loads)}"
            )
        if seconds > LONG:
            lines.append(f"{name} may take up to {significant(seconds, 2)} s: {_cheaper(case.profile, loads)}")
    return lines


def forecast_scene(scene: Scene, batches: Collection[Sequence[Missing]], cores: int) -> tuple[list[str], str]:
    """The expected cost of the batches to be solved, in lines of text, and the reason why they may not run, if any.

    The lines list the cases without a plan, with the reasons. They are empty for a scene without plans and without a
    limit, since the cost models of other methods are upper bounds only. A scene that would exceed its limit is
    refused with the key that raises it.
    """
    members = [member for batch in batches for member in batch]
    with_plans = any(PLANNED in member.case.methods for member in members)
    if not members or (not with_plans and scene.max_seconds is None):
        return [], ""
    longest = max((sum(member.seconds for member in batch) for batch in batches), default=0.0)
    seconds = max(sum(member.seconds for member in members) / cores, longest)
    refused = [f"  {member.refusal}" for member in members if member.refusal]
    count, on = f"{len(members)} case{'s' * (len(members) != 1)}", f"{cores} core{'s' * (cores > 1)}"
    lines = [f"{scene.name}: {count} to solve, in about {significant(seconds, 2)} s on {on}"]
    if refused:
        lines += [f"{scene.name}: no plan for {len(refused)} of them:", *refused[:MAX_LISTED]]
    if len(refused) > MAX_LISTED:
        lines += [f"  and {len(refused) - MAX_LISTED} more"]
    limit = MAX_SCENE_SECONDS if scene.max_seconds is None else scene.max_seconds
    if seconds <= limit:
        return lines, ""
    more = f"add max_seconds: {significant(1.2 * seconds, 2)} to the scene"
    what = f"it would take longer than {limit:g} s: {more}, or take a larger tolerance, fewer cases or more cores"
    return lines, f"{scene.name}: {what}"


def _cheaper(profile: Waves, loads: Array) -> str:
    if not (isinstance(profile, Profile) and find_method(PLANNED).takes(profile)):
        return "choose fewer loads, or a larger shortest wavelength"
    try:
        found = plan(profile, loads)
    except OutOfReachError:
        others = [method for method in registry.METHODS if method.name != PLANNED and method.takes(profile)]
        fast = [method.name for method in others if method.seconds(profile, loads) < LONG]
        return f"choose {', '.join(fast)}, fewer terms or fewer loads"
    cost = f"{significant(found.seconds, 2)} s and {significant(found.memory / 1e6, 2)} MB"
    return (
        f"method {PLANNED!r} takes about {cost} for a compliance within {TOLERANCE:g} g_0, as `weier plan` explains"
    )
