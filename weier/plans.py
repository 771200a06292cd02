"""The plans of a scene with a tolerance, to read before anything runs."""

from __future__ import annotations

from weier.plan import OutOfReachError, Plan, plan
from weier.scene import PLANNED, Case, Scene


def describe_plans(scene: Scene) -> str:
    """The plan of every case of a scene, and what all of them take.

    Raises
    ------
    ValueError
        If the scene has no tolerance.

    """
    cases = {case.key: case for study in scene.studies.values() for case in study if PLANNED in case.methods}
    if not cases:
        raise ValueError(f"scene {scene.name} has no tolerance to plan for: add one, such as tolerance: 1e-3")
    plans = [_plan(scene, case) for case in cases.values()]
    found = [each for each in plans if isinstance(each, Plan)]
    seconds, memory = sum(each.seconds for each in found), max((each.memory for each in found), default=0.0)
    total = f"{len(found)} of {len(plans)} cases can be solved, in about {seconds:.2g} s and {memory / 1e6:.2g} MB"
    return "\n".join([*map(str, plans), total])


def _plan(scene: Scene, case: Case) -> Plan | OutOfReachError:
    try:
        return plan(case.profile, scene.loads, **case.settings.get(PLANNED, {}))
    except OutOfReachError as error:
        return error
