"""The plan of one profile: the cheapest methods, load by load, that the measured laws and the bounds theorem allow.

`weier.methods.planned.curve` runs it, `weier.pipeline.plan` makes one for each case of a scene.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.methods import laws
from weier.methods.errors import OutOfReachError
from weier.methods.planned.candidates import MOST_GRID_POINTS, resolved_lengths, truncation_error, ways
from weier.methods.planned.segment import Part
from weier.theory.loads import checked_loads
from weier.theory.profile import Profile
from weier.theory.terms import truncated

Array = NDArray[np.float64]

TOLERANCE = 1e-3
QUANTITIES = ("compliance", "resistance")
LEAST_LOAD = 1e-300  # p_0*: contact patches and the layer know none lighter


@dataclass(frozen=True)
class Plan:
    """What to run, load by load; `print` it."""

    profile: Profile
    quantity: str
    tolerance: float
    parts: tuple[Part, ...]

    @property
    def error(self) -> float:
        """Largest expected error, in g_0 of a compliance, in the larger of itself and 1 of a resistance."""
        return max(float(part.error.max()) for part in self.parts)

    @property
    def seconds(self) -> float:
        """Expected seconds on one core."""
        return sum(part.seconds for part in self.parts)

    @property
    def memory(self) -> float:
        """Expected bytes beyond those of the interpreter."""
        return max(part.memory for part in self.parts)

    def __str__(self) -> str:
        """The plan to read: a line a part."""
        head = f"{self.profile.describe_with_phases()}: {self.quantity} within {self.tolerance:g}"
        total = f"  in all: error {self.error:.1e}, {self.seconds:.2g} s, {self.memory / 1e6:.2g} MB"
        return "\n".join([head, *map(_line, self.parts), total])


def _line(part: Part) -> str:
    p = part.mean_pressure
    settings = "".join(f", {name} {value:g}" for name, value in part.settings.items())
    return (
        f"  {p.size} loads from {p[0]:.3g} to {p[-1]:.3g}: {part.method} with {part.terms:g} terms{settings}; "
        f"error {part.error.max():.1e} (truncation {part.truncation.max():.1e}, discretisation "
        f"{part.discretisation.max():.1e}, estimate {part.estimate.max():.1e}), {part.seconds:.2g} s, "
        f"{part.memory / 1e6:.2g} MB: {part.why}"
    )


def plan(
    profile: Profile,
    mean_pressure: ArrayLike,
    tolerance: float = TOLERANCE,
    quantity: str = "compliance",
    failed: Sequence[Part] = (),
) -> Plan:
    """The cheapest way to a curve within a tolerance.

    Parameters
    ----------
    profile : Profile
        With any number of terms, inf too.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    tolerance : float
        Of the compliance, in g_0; of the resistance, relative to the larger of itself and 1 g_0/p_0*.
    quantity : "compliance" or "resistance"
        What is to be that accurate.
    failed : sequence of Part
        What is not to be tried again, since it left larger errors than foreseen.

    Returns
    -------
    Plan
        Its parts cover the loads.

    Raises
    ------
    ValueError
        If a load is below 1e-300 p_0*, the tolerance not positive or the quantity unknown; OutOfReachError if no
        method can be that accurate.

    Notes
    -----
    Terms of total amplitude G may be left out: by the bounds theorem h lies within [h_k, h_k + 2 G] of the curve
    h_k of the others (27), and nowhere above its full contact, h = sum g_n. So where the k terms are flat already,
    no term left out changes the middle of what remains by more than G/2.
    """
    loads = checked_loads(mean_pressure)
    _check(loads, tolerance, quantity)
    found = [
        way for way in ways(profile, loads, tolerance, quantity) if not any(way.fails_like(part) for part in failed)
    ]
    if not found or not np.all(np.any([way.error <= tolerance for way in found], axis=0)):
        raise OutOfReachError(_out_of_reach(profile, loads, tolerance, quantity))
    return Plan(profile, quantity, tolerance, cheapest(found, tolerance))


def cheapest(found: Sequence[Part], tolerance: float) -> tuple[Part, ...]:
    """Parts of the ways found that together cover the loads within the tolerance.

    Notes
    -----
    Each load takes the way of least seconds a load, whatever the others take: what is asked for beside a load must
    change neither its value nor its error. The seconds that a way takes to start do not count, therefore.
    """
    cost = np.array([np.where(way.error <= tolerance, way.seconds_load, np.inf) for way in found])
    taken = cost.argmin(axis=0)
    ends = [0, *(np.flatnonzero(np.diff(taken)) + 1).tolist(), len(taken)]
    return tuple(found[taken[first]].at(slice(first, last)) for first, last in pairwise(ends))


def _out_of_reach(profile: Profile, loads: Array, tolerance: float, quantity: str) -> str:
    terms = list(resolved_lengths(profile))[-1]
    rest = truncation_error(profile, truncated(profile, terms), loads, quantity).max()
    best, need = laws.patches_error(min(laws.PATCHES_TOLERANCES), quantity), "larger, or the series shorter"
    if rest > 0:
        why = f"{terms} terms are the most that can be resolved, and the others may change it by {rest:.1e}"
    elif tolerance < best:
        why, need = f"contact patches, the most accurate method, may be off by {best:.1e}", "larger"
    else:
        why = f"too many contacts for contact patches, and boundary elements take over {MOST_GRID_POINTS} points"
    return (
        f"tolerance must be {need}, got {tolerance:g} for the {quantity} of {profile.describe_with_phases()}: {why}"
    )


def _check(loads: Array, tolerance: float, quantity: str) -> None:
    if loads[0] < LEAST_LOAD:
        raise ValueError(f"mean_pressure must be at least {LEAST_LOAD:g} p_0* for a plan, got {loads[0]:g}")
    if quantity not in QUANTITIES:
        raise ValueError(f"quantity must be one of {', '.join(QUANTITIES)}, got {quantity!r}")
    if not 0 < tolerance < math.inf:
        raise ValueError(f"tolerance must be positive and finite, got {tolerance}")
