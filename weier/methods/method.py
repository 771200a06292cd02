"""The definition of a method of solution: one object with all properties that the program uses.

Methods are listed in `weier.methods.registry`. The fields of a method define its solver and where it applies, its
look in figures, its expected seconds, its settings in the tradeoff of speed and accuracy, and its reference at the
extremes.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.errors import NotApplicableError
from weier.surface.limits import check_resolvable
from weier.surface.profile import Profile
from weier.surface.waves import Waves

Settings = Mapping[str, Any]
QUANTITIES = COMPLIANCE, RESISTANCE = "compliance", "resistance"


class Estimate(NamedTuple):
    """The result of a closed form: compliance, in g_0, and resistance, in g_0/p_0*; both of shape (loads,)."""

    compliance: Array
    resistance: Array


class AreaEstimate(NamedTuple):
    """The result of a closed form that also has the contact area; each of shape (loads,)."""

    compliance: Array
    resistance: Array
    contact_fraction: Array


class Style(NamedTuple):
    """The line of a method: its colour, the lengths of dashes and gaps (none for a solid line), and its marker."""

    color: str = "#E69F00"
    dashes: tuple[float, ...] = (9, 2)
    marker: str = "P"


class Noise(NamedTuple):
    """Errors by rounding and iteration: of a height, over the total amplitude; of a slope, relative to itself."""

    height: float = 1e-12
    slope: float = 1e-11


DEFAULT_STYLE, CLOSED_FORM = Style(), Noise()
# The tolerances at which methods that take one are compared, in g_0.
TOLERANCES_COMPARED = tuple(float(f"1e-{decade}") for decade in range(1, 13))


class Reference(NamedTuple):
    """Reference values of compliance and resistance, shape (loads,), floats or numbers of mpmath, and their source.

    resistance_error : the stated error of the resistance, in g_0/p_0*, of the same shape or 0
    """

    compliance: Any
    resistance: Any
    source: str
    resistance_error: Any = 0.0


class Variant(NamedTuple):
    """One competitor in a comparison: a name of at most 16 letters, a method and its settings."""

    name: str
    method: str
    settings: Settings


def applies_to_resolvable(profile: Waves) -> None:
    """Refuse the infinite series, and too many waves in a period, for methods that resolve every wave.

    NotApplicableError is raised if there is no finest wave, or if it fits too often into the period.
    """
    if math.isinf(profile.m):
        raise NotApplicableError(
            "m = inf has no finest wave to resolve: choose a finite m, or a method for the infinite series"
        )
    try:
        check_resolvable(profile)
    except ValueError as error:
        raise NotApplicableError(str(error)) from None


def stated_compliance_error(solved: Any) -> Array:
    """The stated error of the compliance of a solution at each load, in g_0, or 0 if it states none."""
    return np.asarray(getattr(solved, "compliance_error", 0.0))


@dataclass(frozen=True)
class Method:
    """A method of solution.

    Parameters
    ----------
    name : str
        Name in calls and on the command line.
    label : str
        Name in figures and pages.
    summary : str
        Description and range of application, in one line of plain text.
    solve : callable
        From a profile, increasing loads of shape (loads,) in p_0*, and settings as keywords with defaults and
        annotations, to a NamedTuple of `compliance` in g_0, `resistance` in g_0/p_0*, and any other fields of the
        table of variables. Raises ConvergenceError rather than return a wrong number.
    settings : mapping of str
        Meaning and unit of each of these keywords, for help texts.
    applies : callable
        Raises NotApplicableError, with the reason, for a profile to which the method does not apply.
    takes_traces : bool
        Whether it solves any sum of waves, a measured surface too; other methods are for the series only.
    check : callable
        From a profile and settings as keywords, each of the right kind: raises ValueError where `solve` would, before
        anything is solved.
    numerical : bool
        Whether it solves the truncated series itself, so that its curve is exact but for `solution_error`.
    uses_phases : bool
        Whether the curve depends on the phases; if not, profiles that differ in nothing else have the same curve.
    style : Style
        The look of its curve.
    noise : Noise
        Errors of its numbers by rounding and iteration at the default settings.
    algorithms : sequence of settings
        Settings that choose between algorithms: each is compiled in advance, and run at the extremes.
    run_kernels : callable
        Runs kernels to compile them in advance, before any curve: those that do not depend on other methods, so that
        methods are compiled in parallel, and those that only large problems use.
    variants : callable
        From a finite profile to names and settings that trade accuracy for time; a name follows that of the method.
    solution_error : callable
        From the result of `solve` to the error of the compliance, in g_0, of shape (loads,) or one for all loads; by
        default its `compliance_error`, or 0 without one.
    seconds : callable
        From a profile, loads and settings as keywords to the expected seconds of a curve on one core, right within a
        factor of 3; 0 if they are negligible.
    reference : callable, optional
        From a profile and loads to reference values of an estimate, or None if that takes minutes.
    """

    name: str
    label: str
    summary: str
    solve: Callable[..., Any]
    settings: Mapping[str, str] = field(default_factory=dict)
    applies: Callable[..., None] = lambda profile: None
    takes_traces: bool = False
    check: Callable[..., None] = lambda profile, **settings: None
    numerical: bool = False
    uses_phases: bool = True
    style: Style = DEFAULT_STYLE
    noise: Noise = CLOSED_FORM
    algorithms: tuple[Settings, ...] = ({},)
    run_kernels: Callable[[], None] = lambda: None
    variants: Callable[[Profile], Iterable[tuple[str, Settings]]] = lambda profile: [("", {})]
    solution_error: Callable[[Any], Any] = stated_compliance_error
    seconds: Callable[..., float] = lambda profile, loads, **settings: 0.0
    reference: Callable[[Profile, Array], Reference | None] | None = None

    @property
    def returns(self) -> tuple[str, ...]:
        """The names of the values returned by `solve`, from its annotation, a NamedTuple."""
        returned = inspect.signature(self.solve, eval_str=True).return_annotation
        return tuple(getattr(returned, "_fields", ()))

    def check_applies(self, profile: Waves) -> None:
        """Raise NotApplicableError, with the reason, if the method does not apply to a surface."""
        if not (self.takes_traces or isinstance(profile, Profile)):
            raise NotApplicableError(
                f'method "{self.name}" is for the Weierstrass series, got a {profile.describe()}: '
                "take the series that weier.fit finds for it"
            )
        self.applies(profile)

    def takes(self, profile: Waves) -> bool:
        """Whether the method applies to a surface."""
        try:
            self.check_applies(profile)
        except ValueError:
            return False
        return True

    def all_variants(self, profile: Profile) -> list[Variant]:
        """The variants with their full names, such as "bem 96"."""
        own = self.variants(profile)
        return [Variant(f"{self.name} {name}".strip(), self.name, settings) for name, settings in own]
