"""How far off a corrected solution may be, told by what was corrected and by what stands near a birth.

A step of an edge from one node to the next changes the compliance by D (a + b) and the resistance by D
(docs/subgrid.md). What the correction misses is measured in these.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem.edges import Edges
from weier.methods.bem.grid_solution import GridSolution, rate_tolerance
from weier.methods.bem.interaction import BIRTH, WIDE, Contacts
from weier.methods.bem.narrow_contacts import punch_compliance
from weier.methods.bem.polynomials import derivative, value

# Of a step's change of the compliance, and of the resistance, fitted to cover measured errors (docs/subgrid.md):
NEAR = np.array([0.3, 1.0])  # times (narrower run/both)^2, for contacts and gaps that bear on each other
POLYNOMIAL = np.array([0.006, 0.03])  # times (2 pi/points a wave)^4, for polynomials in the place of waves
ALONE = np.array([0.2, 0.3])  # over the nodes of the narrower run, for edges without a polynomial
SHARE = 2.0  # times the tolerance of the rate, for contacts among others: it is that of their shares of the load
LONE = 0.04  # (narrower run/both)^2 of a contact far from its images
RESIDUALS = 3.0  # what the solver leaves of the compliance, in its tolerance
RATE_SHARE = 1e-4  # of the resistance, what the tolerance of the rate may cost: its square
BIRTH_SHARE = 0.1  # of what a new contact takes off the compliance: how others give way to it is known roughly
HEIGHT_SHARE = 6.0  # errors of the compliance by which a crest may stand higher or lower


@kernel
def expected_errors(
    solution: GridSolution, edge: Edges, polynomial: Flags, contacts: Contacts, used: int, angle: float,
    tolerance: float, period: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """Errors of compliance, in g_0, and resistance, in g_0/p_0*; whether a contact may be one too many or too few.

    `angle` is 2 pi/(points a wave).
    """
    errors = np.array([RESIDUALS * tolerance, RATE_SHARE * solution.rate])
    for run in range(edge.size - 2):
        here, before = edge[run + 2] - edge[run + 1], edge[run + 1] - edge[run]
        narrower = min(here, before)
        near = (narrower / (here + before)) ** 2
        alone = 0.0 if polynomial[run] or polynomial[run - 1] else 1 / narrower
        step = _step(edge[run + 1] % solution.pressure.size, solution)
        share = (
            SHARE * rate_tolerance(tolerance) if edge.size > 4 or near > LONE else 0.0
        )  # one small contact carries all, whatever the rate
        errors += step * (NEAR * near + POLYNOMIAL * angle**4 + ALONE * alone + share)
    for at in range(used):
        if contacts.kind[at] == BIRTH and contacts.penetration[at] > 0:
            errors[0] += BIRTH_SHARE * contacts.penetration[at] * contacts.closing[at] / period
    births = 0.0
    uncertain = False
    for at in range(used):
        if contacts.kind[at] != WIDE:
            uncertain |= abs(contacts.penetration[at]) <= HEIGHT_SHARE * errors[0]
            births += _uncertain_birth(contacts, at, HEIGHT_SHARE * errors[0], period)
    return errors[0], errors[1] + births, uncertain


@kernel
def _step(start: int, solution: GridSolution) -> Array:
    """What the step of an edge from one node to the next changes of compliance and resistance."""
    inside, outside = (start, start - 1) if solution.contact[start] else (start - 1, start)
    closing = solution.displacement[inside] - solution.displacement[outside]
    if not (solution.per_load[inside] > 0 and closing > 0):
        return np.zeros(2)
    drop = solution.per_load[inside] * closing / solution.pressure.size
    since = max(solution.pressure[inside], 0.0) / solution.per_load[inside]
    until = max(solution.plane - solution.deformed[outside], 0.0) / closing
    return np.array([drop * (since + until), drop])


@kernel
def _uncertain_birth(contacts: Contacts, at: int, off: float, period: float) -> float:
    """By how much the resistance would differ if a crest stood so much higher or lower."""
    bend = -value(derivative(derivative(contacts.height[at])), contacts.centre[at])
    higher = _drop(contacts, at, contacts.penetration[at] + off, bend, period)
    return higher - _drop(contacts, at, contacts.penetration[at] - off, bend, period)


@kernel
def _drop(contacts: Contacts, at: int, penetration: float, bend: float, period: float) -> float:
    """What a contact takes off the resistance that a crest makes by penetrating so far."""
    if penetration <= 0 or bend <= 0:
        return 0.0
    half_width = min(np.sqrt(2 * penetration / bend) * contacts.scale[at], period / 4)
    return contacts.closing[at] ** 2 / (1 + punch_compliance(half_width, period)) / period
