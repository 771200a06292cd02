"""What a solve or a scene will cost, said before it, with what is cheaper; those out of reach are not begun."""

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
from weier.theory.profile import Profile
from weier.theory.tables import significant
from weier.theory.waves import Waves

LONG = 30.0  # seconds, above which a solve is announced
MAX_SECONDS = 1e5  # a day: who means it chooses settings of the method, whose cost is not known
MAX_SCENE_SECONDS = 600.0  # of a scene with plans, unless it says itself how long it may take
LISTED = 10  # cases that have no plan: others are refused for the same reasons


def forecast(case: Case, loads: Array) -> list[str]:
    """A sentence for each method of a case that its cost model puts above `LONG` at its default settings.

    Raises
    ------
    ValueError
        If one would take longer than `MAX_SECONDS`, with what is cheaper.
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
    """What batches take that are still to be solved, in lines for people, and why they may not run, if so.

    The lines name each case that its plan refuses, with the reason. Only a scene with plans, or with a limit of its
    own, says so: other methods know no more than the most they take. One that would take longer than it allows is
    refused, with the key that allows more.
    """
    members = [each for batch in batches for each in batch]
    with_plans = any(PLANNED in each.case.methods for each in members)
    if not members or (not with_plans and scene.max_seconds is None):
        return [], ""
    longest = max((sum(each.seconds for each in batch) for batch in batches), default=0.0)
    seconds = max(sum(each.seconds for each in members) / cores, longest)
    refused = [f"  {each.refusal}" for each in members if each.refusal]
    count, on = f"{len(members)} case{'s' * (len(members) != 1)}", f"{cores} core{'s' * (cores > 1)}"
    lines = [f"{scene.name}: {count} to solve, in about {significant(seconds, 2)} s on {on}"]
    if refused:
        lines += [f"{scene.name}: no plan for {len(refused)} of them:", *refused[:LISTED]]
    if len(refused) > LISTED:
        lines += [f"  and {len(refused) - LISTED} more"]
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
