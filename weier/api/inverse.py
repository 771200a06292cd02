"""`weier.find_load`: the mean pressure at which the resistance, the compliance or the contact fraction has a value.

All three are monotone in the load p: h and the contact fraction increase, and R = dh/dp decreases, with a drop at
each birth of a contact. Brent's method in ln p finds the load by contact patches. Its error is the distance to the
nearest loads at which the quantity, including its stated error, is certainly above or below the target.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypedDict, Unpack

import numpy as np
import scipy  # Its submodules are loaded on first use.
import xarray as xr
from numpy.typing import ArrayLike

from weier.api.solve import solve
from weier.api.task import CurveTask
from weier.checks import checked_numbers, checked_word
from weier.data import variables
from weier.data.si import marked
from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.load_progress import converting
from weier.methods.registry import EXACT
from weier.methods.settings import TOLERANCE
from weier.surface.limits import check_resolvable
from weier.surface.waves import Waves, checked_surface
from weier.theory.bounds import first_contact
from weier.units import NONE, NORMALISED_PRESSURE

ERROR = "mean_pressure_error"
# tolerance of Brent's method in ln p, a few units of rounding
LOG_ACCURACY = 1e-14
FIRST_DECADES = 1.0  # width of the first bracket, doubled at each step
WIDER = 10.0  # growth factor of the distance to a load that is certainly on one side
# on failure, the tolerance of contact patches grows by LOOSER up to MAX_TOLERANCE
LOOSER, MAX_TOLERANCE = 100.0, 1e-4
JUMP = 1e-6  # relative difference from the target above which the quantity jumps past it


class Wanted(TypedDict, total=False):
    """The target value of one quantity."""

    resistance: ArrayLike
    compliance: ArrayLike
    contact_fraction: ArrayLike


QUANTITIES = tuple(Wanted.__annotations__)


def checked_wanted(wanted: Mapping[str, Any]) -> tuple[str, ArrayLike]:
    """Return the name and the checked target value of the quantity."""
    for name in wanted:
        checked_word("the quantity", name, QUANTITIES)
    if len(wanted) != 1:
        raise ValueError(f"give one of {', '.join(QUANTITIES)}, got {' and '.join(wanted) or 'none'}")
    ((name, value),) = wanted.items()
    return name, value


class Value(NamedTuple):
    """A quantity under one load, and its stated error."""

    value: float
    error: float


def find_load(profile: Waves, **wanted: Unpack[Wanted]) -> xr.Dataset:
    """Find the mean pressure at which a quantity has a given value.

    Parameters
    ----------
    profile : Profile or Trace
        A surface with a finite number of terms.
    **wanted : array_like
        One of resistance, in g_0/p_0*, compliance, in g_0, and contact_fraction: one or several values.

    Returns
    -------
    Dataset
        The curve by contact patches at these loads, in the order of the values. `mean_pressure_error`, in p_0*, is
        the effect of the stated error of the quantity on the load.

    Raises
    ------
    ValueError
        If no load gives the value; the message gives the attainable range.
    ConvergenceError
        If a load of the search cannot be solved.

    Warns
    -----
    UserWarning
        If the resistance drops past the value at a birth; the load of the birth is returned.

    Examples
    --------
    >>> import weier
    >>> found = weier.find_load(weier.Profile(D=1.25, gamma=5, m=2, phases=1.0), resistance=1.5)
    >>> print(found.mean_pressure.values.round(6), found.resistance.values.round(6))
    [0.199413] [1.5]
    """
    return loads_for(profile, *checked_wanted(wanted))


def loads_for(
    profile: Waves, name: str, target: ArrayLike, scales: Mapping[str, tuple[Array, str]] | None = None
) -> xr.Dataset:
    """Find loads as `find_load` does.

    Messages are in the units of `scales`, which has the value and the name of each normalised unit in SI.
    """
    check_resolvable(checked_surface(profile))
    targets = np.atleast_1d(checked_numbers(name, target, unit=VARIABLES[name].unit))
    if targets.ndim != 1 or targets.size == 0:
        raise ValueError(f"{name} must be a number or a list of numbers, got an array of shape {targets.shape}")
    search = _Search(profile, name, scales or {})
    with converting(lambda curve: None):  # a curve of the search, not of the caller
        found = [search.load(float(value)) for value in targets]
    loads, errors = np.array(found).T
    curve = solve(profile, loads, EXACT.name, tolerance=search.tolerance)
    attributes = variables.attributes(ERROR)
    dropped = np.flatnonzero(np.abs(curve[name].values - targets) > JUMP * targets)
    if name == "resistance" and dropped.size:
        which = "the wanted value" if targets.size == 1 else f"{dropped.size} of {targets.size} wanted values"
        warnings.warn(
            f"the resistance drops past {which} where a contact is born: the load is that of the birth",
            stacklevel=3,  # points to the call of `find_load`
        )
    return marked(curve.assign({ERROR: ("mean_pressure", errors, attributes)}))


class _Search:
    """Loads of one surface at which a quantity has a value."""

    def __init__(self, profile: Waves, name: str, scales: Mapping[str, tuple[Array, str]]) -> None:
        self.profile, self.name, self.scales = profile, name, scales
        self.falls = name == "resistance"
        # Compliance is compared as indentation, which is accurate under light loads.
        self.offset = first_contact(profile) if name == "compliance" else 0.0
        self.full = float(profile.full_contact_load)
        self.known = dict[float, Value]()
        self.tolerance = EXACT.settings[TOLERANCE].default

    def load(self, target: float) -> tuple[float, float]:
        """Return the load, and its error, in p_0*."""
        self._check(target)
        value = target - self.offset

        def rising(log_load: float) -> float:
            """Return a function that increases with the load and vanishes at the target."""
            return (value - self.at(log_load).value) if self.falls else self.at(log_load).value - value

        high = math.log(self.full)
        low, width = high, FIRST_DECADES * math.log(10)
        least = math.log(EXACT.least_load)
        while rising(low) > 0:
            if low == least:
                raise ValueError(self._limits(target))
            high, low, width = low, max(low - width, least), 2 * width
        root = float(scipy.optimize.brentq(rising, low, high, xtol=LOG_ACCURACY)) if low < high else low
        load = math.exp(root)
        off = max(self._distance(root, rising, side) for side in (-1, 1))
        return load, load * math.expm1(off)

    def _distance(self, root: float, rising: Callable[[float], float], side: int) -> float:
        """Return the distance from the root, in ln p, beyond which the side of the target is certain."""
        distance = LOG_ACCURACY
        while side * rising(root + side * distance) <= self.at(root + side * distance).error:
            if root + side * distance >= math.log(self.full):
                break
            distance *= WIDER
        return distance

    def at(self, log_load: float) -> Value:
        """Return the quantity under one load."""
        if log_load not in self.known:
            found = self._curve(min(math.exp(log_load), self.full))
            value = found.indentation if self.name == "compliance" else getattr(found, self.name)
            self.known[log_load] = Value(float(value[0]), float(getattr(found, f"{self.name}_error")[0]))
        return self.known[log_load]

    def _curve(self, load: float) -> Any:
        """Return the solution under one load, at the tightest tolerance that can be met."""
        while True:
            curve = CurveTask(self.profile, EXACT.name, {"tolerance": self.tolerance}, np.array([load]))
            try:
                return curve.solve()[0]
            except ConvergenceError:
                self.tolerance *= LOOSER
                if self.tolerance > MAX_TOLERANCE:
                    raise

    def _check(self, target: float) -> None:
        """Refuse a value that is attained at no load, or at all loads beyond full contact."""
        top = float(self.profile.total_amplitude)
        low, high = {"resistance": (0.0, math.inf), "compliance": (self.offset, top)}.get(self.name, (0.0, 1.0))
        if not low < target < high:
            raise ValueError(self._limits(target))

    def _limits(self, target: float) -> str:
        unit, pressure = VARIABLES[self.name].unit, NORMALISED_PRESSURE
        full = f"full contact under {self._shown(self.full, pressure)}"
        first = self._shown(self.at(math.log(EXACT.least_load)).value + self.offset, unit)
        low, top = (self._shown(height, unit) for height in (self.offset, float(self.profile.total_amplitude)))
        limits = {
            "resistance": f"between 0, from {full} on, and {first}, under the lightest load of "
            f"{self._shown(EXACT.least_load, pressure)}",
            "compliance": f"between {low}, at first contact, and {top}, at {full}",
            "contact_fraction": f"between 0, at first contact, and 1, at {full}",
        }
        return f"{self.name} must lie {limits[self.name]}, got {self._shown(target, unit)}"

    def _shown(self, value: float, unit: str) -> str:
        """Return a value with its unit, in SI if the scales have one for it."""
        factor, name = self.scales.get(unit, (1.0, unit))
        return f"{value * float(factor):.6g}{'' if name == NONE else f' {name}'}"
