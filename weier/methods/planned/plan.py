"""The plan of one profile: the cheapest methods, load by load, that error models and the bounds theorem allow.

It chooses as in docs/planned.md, "The choice"; "What is offered" has what is offered for which quantity.

`weier.methods.planned.solver` runs it, `weier.pipeline.plan` makes one for each case of a scene.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_number, checked_word
from weier.kernels.arrays import Array, Flags
from weier.methods.errors import OutOfReachError
from weier.methods.method import Method
from weier.methods.plan_part import COMPLIANCE, QUANTITIES, RESISTANCE, PlanPart
from weier.methods.planned.candidates import candidates
from weier.methods.planned.truncations import expected_chords, resolvable_lengths
from weier.surface.loads import checked_loads
from weier.surface.profile import Profile
from weier.tables import html_table, significant, text_table

TOLERANCE = 1e-3
MIN_LOAD = 1e-300  # p_0*; contact patches and the layer take none lighter.
SECONDS_PLAN, SECONDS_PART = 4e-3, 1.5e-4  # Seconds to plan, and to assemble the solution of a part.
# Where a tolerance is out of reach, the least of these that is within reach is suggested.
SUGGESTED = [10.0**exponent for exponent in range(-13, 0)]


@dataclass(frozen=True)
class Plan:
    """What to run, load by load; Python shows it as a table.

    profile, quantity, tolerance : what it was made for, as in `weier.plan`
    parts : loads that one method solves, in increasing order
    """

    profile: Profile
    quantity: str
    tolerance: float
    parts: tuple[PlanPart, ...]

    @property
    def error(self) -> float:
        """Largest expected error: of h in g_0, or of R relative to the larger of itself and 1 g_0/p_0*."""
        return max(float(part.error.max()) for part in self.parts)

    @property
    def seconds(self) -> float:
        """Expected seconds of planning and of all parts together, on one core."""
        return SECONDS_PLAN + sum(part.seconds + SECONDS_PART for part in self.parts)

    @property
    def memory(self) -> float:
        """Expected bytes of the largest part, beyond those of the interpreter."""
        return max(part.memory for part in self.parts)

    def __repr__(self) -> str:
        """The plan to read: a table with a line for each part."""
        return "\n".join([self._head, text_table(HEADER, list(map(_row, self.parts))), f"  {self._total}"])

    def _repr_html_(self) -> str:
        """The table, for notebooks."""
        return html_table(self._head, HEADER, list(map(_row, self.parts)), self._total)

    @property
    def _head(self) -> str:
        return f"{self.profile.describe_with_phases()}: {self.quantity} within {self.tolerance:g}"

    @property
    def _total(self) -> str:
        cost = f"{significant(self.seconds, 2)} s, {significant(self.memory / 1e6, 2)} MB"
        return f"in all: error {self.error:.1e}, {cost}"


ERRORS = ("error", "truncation", "discretisation", "estimate")  # of a part
HEADER = ("loads", "from", "to", "method", "terms", "settings", *ERRORS, "seconds", "MB", "why")


def _row(part: PlanPart) -> list[str]:
    p = part.mean_pressure
    largest = [getattr(part, name).max() for name in ERRORS]
    return [
        f"{p.size}",
        f"{p[0]:.3g}",
        f"{p[-1]:.3g}",
        part.method,
        f"{part.terms:g}",
        ", ".join(f"{name} {_short(value)}" for name, value in part.settings.items()),
        *(f"{error:.1e}" if error else "0" for error in largest),
        significant(part.seconds, 2),
        significant(part.memory / 1e6, 2),
        part.why,
    ]


def _short(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def plan(
    profile: Profile,
    mean_pressure: ArrayLike,
    methods: Sequence[Method],
    tolerance: float = TOLERANCE,
    quantity: str = COMPLIANCE,
    failed: Sequence[PlanPart] = (),
) -> Plan:
    """The cheapest methods for a curve within a tolerance.

    Parameters
    ----------
    profile : Profile
        With any number of terms, inf too.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    methods : sequence of Method
        To choose from.
    tolerance : float
        Of the compliance, in g_0; of the resistance, relative to the larger of itself and 1 g_0/p_0*.
    quantity : "compliance" or "resistance"
        What is to be that accurate.
    failed : sequence of PlanPart
        Parts that are not to be tried again, since their solutions stated larger errors than expected.

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
    if loads[0] < MIN_LOAD:
        raise ValueError(f"mean_pressure must be at least {MIN_LOAD:g} p_0* for a plan, got {loads[0]:g}")
    checked_word("quantity", quantity, QUANTITIES)
    tolerance = checked_number("tolerance", tolerance, "be positive and finite", lambda number: 0 < number < math.inf)
    offers = _offers(profile, loads, methods, tolerance, quantity, failed)
    if not _covered(offers, loads, tolerance).all():
        raise OutOfReachError(_out_of_reach(profile, loads, tolerance, quantity, methods))
    return Plan(profile, quantity, tolerance, cheapest(offers, tolerance))


def within_reach(
    profile: Profile,
    loads: Array,
    methods: Sequence[Method],
    tolerance: float,
    quantity: str,
    failed: Sequence[PlanPart],
) -> Flags:
    """The loads at which there is a plan; `plan` raises an error unless there is one at all of them."""
    return _covered(_offers(profile, loads, methods, tolerance, quantity, failed), loads, tolerance)


def _offers(
    profile: Profile,
    loads: Array,
    methods: Sequence[Method],
    tolerance: float,
    quantity: str,
    failed: Sequence[PlanPart] = (),
) -> list[PlanPart]:
    offers = candidates(profile, loads, tolerance, quantity, methods)
    return [offer for offer in offers if not any(offer.fails_like(other) for other in failed)]


def cheapest(offers: Sequence[PlanPart], tolerance: float) -> tuple[PlanPart, ...]:
    """Parts of the offers that together cover the loads within the tolerance.

    Notes
    -----
    Each load takes the offer of the least seconds a load, whatever the others take: neither the value of a load nor
    its error may depend on the other loads. So the seconds that a method takes to start do not count.
    """
    cost = np.array([np.where(offer.error <= tolerance, offer.seconds_load, np.inf) for offer in offers])
    taken = cost.argmin(axis=0)
    ends = [0, *(np.flatnonzero(np.diff(taken)) + 1).tolist(), len(taken)]
    return tuple(offers[taken[first]].at(slice(first, last)) for first, last in pairwise(ends))


def _covered(offers: Sequence[PlanPart], loads: Array, tolerance: float) -> Flags:
    """Whether at each load some offer is within the tolerance."""
    covered = np.zeros(loads.size, bool)
    for offer in offers:
        covered |= offer.error <= tolerance
    return covered


def _out_of_reach(profile: Profile, loads: Array, tolerance: float, quantity: str, methods: Sequence[Method]) -> str:
    terms = resolvable_lengths(profile)[-1]
    change = profile.amplitude_beyond(terms)  # of the compliance, by the bounds theorem
    if change > 0:
        if quantity == RESISTANCE:
            change = expected_chords(profile.truncated(terms), loads, change)[0].max()
        need = "larger, or the series shorter"
        why = f"{terms} terms are the most that can be resolved, and the others may change it by {change:.1e}"
    else:
        need, why = "larger", "no method can hold the contacts or the grid that it takes, or is as accurate"
    wider = (larger for larger in SUGGESTED if larger > tolerance)
    reached = (
        larger
        for larger in wider
        if _covered(_offers(profile, loads, methods, larger, quantity), loads, larger).all()
    )
    within = next((f"{larger:.0e} is within reach" for larger in reached), "no power of ten below 1 is within reach")
    return (
        f"tolerance must be {need}, got {tolerance:g} for the {quantity} of {profile.describe_with_phases()}: "
        f"{why}; {within}"
    )
