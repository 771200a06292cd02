"""The definition of a method of solution: one object with all properties that the program uses.

Methods are listed in `weier.methods.registry`. The fields of a method declare what it can do, its settings
with their ranges, its look in figures and its expected seconds. What measurements compare is in
`weier.accuracy.tradeoff`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from weier.checks import checked_count, checked_number, checked_word
from weier.methods.curve import Curve
from weier.methods.errors import NotApplicableError
from weier.surface.profile import Profile
from weier.surface.waves import Waves, check_resolvable

Settings = Mapping[str, Any]
CURVE_SECONDS = 5e-4  # seconds of the simplest curve: `python -m benchmarks expected_seconds`
CURVES, OTHERS = ".curves", ".others"  # shares of the kernels of a method: of curves of few waves, and `run_kernels`


class Style(NamedTuple):
    """The line of a method: its colour, the lengths of dashes and gaps (none for a solid line), and its marker."""

    color: str = "#E69F00"
    dashes: tuple[float, ...] = (9, 2)
    marker: str = "P"


DEFAULT_STYLE = Style()


def applies_to_resolvable(profile: Waves) -> None:
    """Raise NotApplicableError if the period has too many waves, for methods that resolve every wave."""
    try:
        check_resolvable(profile)
    except ValueError as error:
        raise NotApplicableError(str(error)) from None


class Range(NamedTuple):
    """The range of a number: whole, if its ends are of type int; without its upper end, if it is half-open."""

    least: float
    most: float
    half_open: bool = False

    def __contains__(self, number: object) -> bool:
        return isinstance(number, float | int) and (
            self.least <= number < self.most if self.half_open else self.least <= number <= self.most
        )

    def __str__(self) -> str:
        return f"[{self.least:g}, {self.most:g}{')' if self.half_open else ']'}"


TOLERANCES = Range(1e-13, 1.0, half_open=True)  # g_0; rounding of fields dominates smaller errors


class Setting(NamedTuple):
    """A keyword of a solver.

    default : value unless one is given; if it is None, None may be given as well
    meaning : description with its unit, for help texts
    values : the range of a number, or the words to choose from
    """

    default: Any
    meaning: str
    values: Range | tuple[str, ...]

    def checked(self, name: str, value: Any) -> Any:
        """Return a value of this setting; ValueError is raised if it is of another kind or out of range."""
        if value is None and self.default is None:
            return None
        if not isinstance(self.values, Range):
            return checked_word(name, value, self.values)
        if isinstance(self.values.least, int):
            return checked_count(name, value, self.values.least, self.values.most)
        return checked_number(name, value, f"lie in {self.values}", self.values.__contains__)


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
        From a surface, increasing loads of shape (loads,) in p_0*, and settings as keywords with their defaults,
        to a Curve. Raises ConvergenceError rather than return a wrong number.
    returns : tuple of str
        The quantities of this Curve other than compliance and resistance.
    settings : mapping of Setting
        These keywords, by name.
    chosen : callable
        From given settings to the values of settings whose default None stands for a value.
    takes_traces : bool
        Whether it solves any sum of waves, a measured surface too; if not, the Weierstrass series only.
    infinite : bool
        Whether it solves the infinite series.
    applies : callable
        Raises NotApplicableError, with the reason, for other profiles to which the method does not apply.
    check : callable
        From a profile and settings as keywords, each of the right kind: raises ValueError where `solve` would, before
        anything is solved.
    numerical : bool
        Whether it solves the truncated series itself, so that its curve is exact but for its `compliance_error`.
    uses_phases : bool
        Whether the curve depends on the phases; if not, profiles that differ only in phases have the same curve.
    least_load : float
        Least load, in p_0*.
    stiffness : bool
        Whether it has compliance and resistance; if not, they are NaN, as its summary says.
    in_paper : bool
        Whether it is a method of the paper: axes of figures follow the curves of these and of numerical methods.
    style : Style
        The look of its curve.
    seconds : callable
        From a profile, loads and settings as keywords to the expected seconds of a curve on one core, right within a
        factor of 5: `CURVE_SECONDS`, and a law with one to three measured numbers.
    run_kernels : callable or None
        Runs compiled functions that curves of few waves do not reach, for `weier compile`.
    """

    name: str
    label: str
    summary: str
    solve: Callable[..., Curve]
    returns: tuple[str, ...] = ()
    settings: Mapping[str, Setting] = field(default_factory=dict)
    chosen: Callable[[Settings], Settings] = lambda given: {}
    takes_traces: bool = False
    infinite: bool = False
    applies: Callable[..., None] = lambda profile: None
    check: Callable[..., object] = lambda profile, **settings: None
    numerical: bool = False
    uses_phases: bool = True
    least_load: float = 0.0
    stiffness: bool = True
    in_paper: bool = False
    style: Style = DEFAULT_STYLE
    seconds: Callable[..., float] = lambda profile, loads, **settings: CURVE_SECONDS
    run_kernels: Callable[[], object] | None = None

    @property
    def kernels(self) -> list[str]:
        """The names of shares of its kernels, which can be compiled at once."""
        return [self.name + share for share in (CURVES, OTHERS) if share == CURVES or self.run_kernels]

    def check_applies(self, profile: Waves) -> None:
        """Raise NotApplicableError, with the reason, if the method does not apply to a surface."""
        if not (self.takes_traces or isinstance(profile, Profile)):
            raise NotApplicableError(
                f'method "{self.name}" is for the Weierstrass series, got a {profile.describe()}: '
                "take the series that weier.fit finds for it"
            )
        if math.isinf(profile.m) and not self.infinite:
            raise NotApplicableError(
                "m = inf has no finest wave to resolve: choose a finite m, or a method for the infinite series"
            )
        self.applies(profile)

    def takes(self, profile: Waves) -> bool:
        """Return whether the method applies to a surface."""
        try:
            self.check_applies(profile)
        except ValueError:
            return False
        return True
