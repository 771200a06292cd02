"""The definition of a method of solution: one object with all properties that the program uses.

Methods are listed in `weier.methods.registry`. The fields of a method define its solver and where it applies, its
look in figures and its expected seconds. What measurements compare is in `weier.accuracy.variants`.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, NamedTuple

from weier.methods.curve import Curve
from weier.methods.errors import NotApplicableError
from weier.surface.limits import check_resolvable
from weier.surface.profile import Profile
from weier.surface.waves import Waves

Settings = Mapping[str, Any]
CURVE_SECONDS = 5e-4  # of the simplest curve: `python -m benchmarks expected_seconds`


class Style(NamedTuple):
    """The line of a method: its colour, the lengths of dashes and gaps (none for a solid line), and its marker."""

    color: str = "#E69F00"
    dashes: tuple[float, ...] = (9, 2)
    marker: str = "P"


DEFAULT_STYLE = Style()


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


@cache
def _annotations(solve: Callable[..., Any]) -> Mapping[str, Any]:
    return inspect.get_annotations(solve, eval_str=True)


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
        From a surface, increasing loads of shape (loads,) in p_0*, and settings as keywords with defaults and
        annotations, to a Curve. Raises ConvergenceError rather than return a wrong number. A first parameter of type
        Profile says that it solves the series only, Waves that it takes traces, too.
    returns : tuple of str
        The quantities of this Curve other than compliance and resistance.
    settings : mapping of str
        Meaning and unit of each of these keywords, for help texts.
    chosen : callable
        From given settings to the values of settings whose default None stands for a value.
    applies : callable
        Raises NotApplicableError, with the reason, for a profile to which the method does not apply.
    check : callable
        From a profile and settings as keywords, each of the right kind: raises ValueError where `solve` would, before
        anything is solved.
    numerical : bool
        Whether it solves the truncated series itself, so that its curve is exact but for its `compliance_error`.
    uses_phases : bool
        Whether the curve depends on the phases; if not, profiles that differ in nothing else have the same curve.
    stiffness : bool
        Whether it has compliance and resistance; if not, they are NaN, as its summary says.
    in_paper : bool
        Whether it is a method of the paper: axes of figures follow the curves of these and of numerical methods.
    style : Style
        The look of its curve.
    seconds : callable
        From a profile, loads and settings as keywords to the expected seconds of a curve on one core, right within a
        factor of 5: `CURVE_SECONDS`, and a power law with one measured number.
    """

    name: str
    label: str
    summary: str
    solve: Callable[..., Curve]
    returns: tuple[str, ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)
    chosen: Callable[[Settings], Settings] = lambda given: {}
    applies: Callable[..., None] = lambda profile: None
    check: Callable[..., None] = lambda profile, **settings: None
    numerical: bool = False
    uses_phases: bool = True
    stiffness: bool = True
    in_paper: bool = False
    style: Style = DEFAULT_STYLE
    seconds: Callable[..., float] = lambda profile, loads, **settings: CURVE_SECONDS

    @property
    def takes_traces(self) -> bool:
        """Whether it solves any sum of waves, a measured surface too."""
        return next(iter(_annotations(self.solve).values()), None) is not Profile

    def check_applies(self, profile: Waves) -> None:
        """Raise NotApplicableError, with the reason, if the method does not apply to a surface."""
        if not (self.takes_traces or isinstance(profile, Profile)):
            raise NotApplicableError(
                f'method "{self.name}" is for the Weierstrass series, got a {profile.describe()}: '
                "take the series that weier.fit finds for it"
            )
        self.applies(profile)

    def takes(self, profile: Waves) -> bool:
        """Return whether the method applies to a surface."""
        try:
            self.check_applies(profile)
        except ValueError:
            return False
        return True
