"""`weier.find_load`: the mean pressure at which the resistance, the compliance or the contact fraction has a value.

All three are monotone in the load p: h and the contact fraction increase, and R = dh/dp decreases, with a drop at
each birth of a contact. Brent's method in ln p finds the load by contact patches. Its error is the distance to the
nearest loads at which the quantity, including its stated error, is certainly above or below the target.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import scipy  # Its submodules are loaded on first use.
import xarray as xr
from numpy.typing import ArrayLike

from weier.api.solve import solve
from weier.api.task import CurveTask
from weier.checks import checked_numbers
from weier.data import variables
from weier.data.si import marked
from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.methods.load_progress import converting
from weier.methods.registry import EXACT
from weier.methods.settings import TOLERANCE
from weier.surface.waves import Waves, check_resolvable, checked_surface
from weier.theory.bounds import first_contact
from weier.units import NONE, NORMALISED_PRESSURE

ERROR = "mean_pressure_error"
# tolerance of Brent's method in ln p, a few units of rounding
LOG_ACCURACY = 1e-14
FIRST_WIDTH = math.log(10)  # width of the first bracket in ln p, doubled at each step
ABOVE = 1 + 1e-12  # full contact has no gap left by rounding at this multiple of its least load
WIDER = 10.0  # growth factor of the distance to a load that is certainly on one side
JUMP = 1e-6  # relative difference from the target above which the quantity jumps past it
QUANTITIES = ("resistance", "compliance", "contact_fraction")


def wanted_quantity(*wanted: ArrayLike | None) -> tuple[str, ArrayLike]:
    """Return the name and the values of the only quantity that is given, in the order of `QUANTITIES`."""
    given = [(name, values) for name, values in zip(QUANTITIES, wanted, strict=True) if values is not None]
    if len(given) != 1:
        names = " and ".join(name for name, _ in given) or "none"
        raise ValueError(f"give one of {', '.join(QUANTITIES)}, got {names}")
    return given[0]


def find_load(
    profile: Waves,
    *,
    resistance: ArrayLike | None = None,
    compliance: ArrayLike | None = None,
    contact_fraction: ArrayLike | None = None,
) -> xr.Dataset:
    """Find the mean pressure at which a quantity has a given value.

    Parameters
    ----------
    profile : Profile or Trace
        A surface with a finite number of terms.
    resistance, compliance, contact_fraction : array_like
        One of these, in g_0/p_0*, in g_0, or as a fraction: one or several values.

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
    return loads_for(profile, *wanted_quantity(resistance, compliance, contact_fraction))


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
    with converting(lambda curve: None):  # drops curves of the search
        found = [search.load(float(value)) for value in targets]
    loads, errors = np.array(found).T
    curve = solve(profile, loads, EXACT.name)
    dropped = np.flatnonzero(np.abs(curve[name].values - targets) > JUMP * targets)
    if name == "resistance" and dropped.size:
        which = "the wanted value" if targets.size == 1 else f"{dropped.size} of {targets.size} wanted values"
        warnings.warn(
            f"the resistance drops past {which} where a contact is born: the load is that of the birth",
            stacklevel=3,  # points to the call of `find_load`
        )
    return marked(curve.assign({ERROR: ("mean_pressure", errors, variables.attributes(ERROR))}))


class _Search:
    """Loads of one surface at which a quantity has a value."""

    def __init__(self, profile: Waves, name: str, scales: Mapping[str, tuple[Array, str]]) -> None:
        self.profile, self.name, self.scales = profile, name, scales
        self.sign = -1 if name == "resistance" else 1  # sign of the slope over the load
        # Compliance is compared as indentation, which is accurate under light loads.
        self.offset = first_contact(profile) if name == "compliance" else 0.0
        self.least, self.full = math.log(EXACT.least_load), math.log(ABOVE * profile.full_contact_load)
        self.settings = {TOLERANCE: EXACT.settings[TOLERANCE].default}
        self.known = dict[float, tuple[float, float]]()  # maps ln p to the quantity and its stated error

    def load(self, target: float) -> tuple[float, float]:
        """Return the load, and its error, in p_0*."""
        value = target - self.offset

        def rising(log_load: float) -> float:
            """Return a function that increases with the load and vanishes at the target."""
            return self.sign * (self.at(log_load)[0] - value)

        low, high, width = self.full, self.full, FIRST_WIDTH
        if not rising(low) > 0:  # all loads beyond full contact give the value, or none does
            raise ValueError(self._limits(value))
        while rising(low) > 0:
            if low == self.least:
                raise ValueError(self._limits(value))
            high, low, width = low, max(low - width, self.least), 2 * width
        root = float(scipy.optimize.brentq(rising, low, high, xtol=LOG_ACCURACY))
        off = max(self._distance(root, rising, side) for side in (-1, 1))
        return math.exp(root), math.exp(root) * math.expm1(off)

    def _distance(self, root: float, rising: Callable[[float], float], side: int) -> float:
        """Return the distance from the root, in ln p, beyond which the side of the target is certain."""
        distance = LOG_ACCURACY
        while (load := root + side * distance) < self.full and side * rising(load) <= self.at(load)[1]:
            distance *= WIDER
        return distance

    def at(self, log_load: float) -> tuple[float, float]:
        """Return the quantity under one load, and its stated error."""
        if log_load not in self.known:
            found: Any = CurveTask(self.profile, EXACT.name, self.settings, np.array([math.exp(log_load)])).solve()[0]
            value = found.indentation if self.name == "compliance" else getattr(found, self.name)
            self.known[log_load] = float(value[0]), float(getattr(found, f"{self.name}_error")[0])
        return self.known[log_load]

    def _limits(self, value: float) -> str:
        """Return the message for a value that no load gives, or all loads beyond full contact."""
        unit, ends = VARIABLES[self.name].unit, (self.least, self.full)
        least, most = (self._shown(self.at(load)[0] + self.offset, unit) for load in ends)
        lightest, full = (self._shown(math.exp(load), NORMALISED_PRESSURE) for load in ends)
        return (
            f"{self.name} must lie strictly between {least}, under the lightest load of {lightest}, and {most}, from "
            f"full contact under {full} on, got {self._shown(value + self.offset, unit)}"
        )

    def _shown(self, value: float, unit: str) -> str:
        """Return a value with its unit, in SI if the scales have one for it."""
        factor, name = self.scales.get(unit, (1.0, unit))
        return f"{value * float(factor):.6g}{'' if name == NONE else f' {name}'}"
