"""`weier.plan`: the plan of one profile, by `weier.methods.planned.plan.plan`, or those of all cases of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any, overload

from numpy.typing import ArrayLike

from weier.checks import hinting, shown
from weier.methods import registry
from weier.methods.errors import OutOfReachError
from weier.methods.planned.plan import Plan
from weier.methods.planned.plan import plan as plan_profile
from weier.methods.registry import PLANNED
from weier.scene import Case, Scene
from weier.surface.loads import listed_loads
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile
from weier.tables import significant


@dataclass(frozen=True)
class ScenePlan:
    """The plan of each case by its key, or the error if there is none; it is displayed as tables."""

    cases: Mapping[str, Plan | OutOfReachError]

    @property
    def plans(self) -> list[Plan]:
        """The plans of the cases that can be solved."""
        return [found for found in self.cases.values() if isinstance(found, Plan)]

    @property
    def seconds(self) -> float:
        """Expected seconds on one core."""
        return sum(found.seconds for found in self.plans)

    def __repr__(self) -> str:
        """The plan of every case, and their total cost."""
        others = ["not the others:", *(f"  {found}" for found in self._others)] if self._others else []
        return "\n".join([*(f"{found}\n" for found in self.plans), self._sum_up, *others])

    def _repr_html_(self) -> str:
        """Tables for notebooks."""
        others = "".join(f"<li>{escape(str(found))}</li>" for found in self._others)
        below = f"<p>not the others:</p><ul>{others}</ul>" if others else ""
        return f"{''.join(found._repr_html_() for found in self.plans)}<p>{self._sum_up}</p>{below}"

    @property
    def _others(self) -> list[OutOfReachError]:
        return [found for found in self.cases.values() if isinstance(found, OutOfReachError)]

    @property
    def _sum_up(self) -> str:
        memory = max((found.memory for found in self.plans), default=0.0)  # bytes
        cost = f"{significant(self.seconds, 2)} s and {significant(memory / 1e6, 2)} MB"
        return f"{len(self.plans)} of {len(self.cases)} cases can be solved, in about {cost}"


@overload
def plan(
    subject: Profile, mean_pressure: ArrayLike, tolerance: float | None = None, quantity: str | None = None
) -> Plan: ...
@overload
def plan(
    subject: Scene,
    mean_pressure: ArrayLike | None = None,
    tolerance: float | None = None,
    quantity: str | None = None,
) -> ScenePlan: ...
@hinting
def plan(
    subject: Profile | Scene,
    mean_pressure: ArrayLike | None = None,
    tolerance: float | None = None,
    quantity: str | None = None,
) -> Plan | ScenePlan:
    """The cheapest methods for curves within a tolerance, load by load; nothing is solved.

    Parameters
    ----------
    subject : Profile or Scene
        With any number of terms, inf too; a scene as `weier.load_scene` reads it.
    mean_pressure : array_like, shape (loads,)
        Positive, in p_0*, in any order; the plan has each once, increasing. By default, those of the scene; a
        profile has none.
    tolerance : float
        Of the compliance, in g_0; of the resistance, relative to the larger of itself and 1 g_0/p_0*. By default,
        that of the scene, and 1e-3 for a profile.
    quantity : "compliance" or "resistance"
        The quantity of the tolerance. By default, that of the scene, and the compliance for a profile.

    Returns
    -------
    Plan or ScenePlan
        The methods with their terms, points, seconds, errors and reasons; it is displayed as a table.

    Raises
    ------
    ValueError
        If the tolerance is not positive, the quantity is unknown, or a profile has no loads or a scene no tolerance;
        OutOfReachError if no method meets the tolerance for a profile.

    Examples
    --------
    >>> import weier
    >>> found = weier.plan(weier.Profile(D=1.25, gamma=5, m=3), [0.01, 0.1, 20], tolerance=1e-4)
    >>> [part.method for part in found.parts]
    ['bem', 'full contact']

    """
    given = {"tolerance": tolerance, "quantity": quantity}
    wanted: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    if isinstance(subject, Scene):
        return _plan_scene(
            subject, subject.loads if mean_pressure is None else listed_loads(mean_pressure)[0], wanted
        )
    if isinstance(subject, Trace):
        raise ValueError(
            "subject must be a series to plan for, got a trace: take the one that weier.fit finds for it"
        )
    if not isinstance(subject, Profile):
        raise ValueError(f"subject must be a weier.Profile or a scene, got {shown(subject)}")
    if mean_pressure is None:
        raise ValueError("mean_pressure must be given with a profile: only a scene has loads of its own")
    return plan_profile(subject, listed_loads(mean_pressure)[0], registry.METHODS, **wanted)


def _plan_scene(scene: Scene, loads: ArrayLike, wanted: Mapping[str, Any]) -> ScenePlan:
    series = {key: case for key, case in scene.cases.items() if isinstance(case.profile, Profile)}
    if not series:
        raise ValueError(f"scene {scene.name} has traces alone: plan for the series that weier.fit finds for them")
    cases = {key: case for key, case in series.items() if "tolerance" in wanted or PLANNED in case.methods}
    if not cases:
        raise ValueError(f"scene {scene.name} has no tolerance to plan for: add one, such as tolerance: 1.0e-3")
    return ScenePlan({key: plan_case(case, loads, **wanted) for key, case in cases.items()})


def plan_case(case: Case, loads: ArrayLike, **wanted: Any) -> Plan | OutOfReachError:
    """The plan of a case by its settings or those given; or the error if there is none."""
    try:
        return plan_profile(case.profile, loads, registry.METHODS, **{**case.settings.get(PLANNED, {}), **wanted})
    except OutOfReachError as error:
        return error
