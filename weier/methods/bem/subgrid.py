"""Edges of contact between the nodes: what the continuum adds to a solution on a grid (docs/subgrid.md)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.jit import kernel
from weier.methods.bem.contact_list import ContactList, list_contacts
from weier.methods.bem.contacts import find_contacts, find_crests
from weier.methods.bem.errors import estimate_errors
from weier.methods.bem.grid_solution import Continuum, GridSolution
from weier.methods.bem.lone_edges import find_steps
from weier.methods.bem.narrow_gaps import Gaps
from weier.methods.bem.redistribution import redistribute

MAX_ROUNDS = 5  # of judging crests again


class LoadSolution(NamedTuple):
    """One load, with edges of contact between the nodes.

    verified : whether forces were found that are positive, and no crest stands above the plane but those that touch
    plane : mean gap d, in g_0
    resistance : dh/dp, in g_0/p_0*
    compliance_error, resistance_error : estimates, in the same units
    contacts : in the continuum
    uncertain : whether a contact or a gap may be one too many or too few
    residual, work : of the solution on the grid
    """

    verified: bool
    plane: float
    resistance: float
    compliance_error: float
    resistance_error: float
    contacts: ContactList
    uncertain: bool
    residual: float
    work: float


@kernel
def correct_contacts(
    gaps: Gaps, solution: GridSolution, continuum: Continuum, residual: float, work: float
) -> LoadSolution:
    """Correct a converged solution, whose gaps are `gaps`, by what the continuum adds to it.

    Crests that may touch are told by the plane on the grid at first. The corrected plane and pressure judge all
    crests again, until no more of them may touch.
    """
    points = solution.pressure.size
    steps = find_steps(solution)
    crest = np.zeros(points, np.bool_)
    crests = find_crests(solution.plane, solution, np.zeros(points), crest)
    for _ in range(MAX_ROUNDS):
        contacts, polynomial = find_contacts(crest, crests, gaps, steps, solution, continuum)
        forces = redistribute(contacts, solution.plane, solution.rate, continuum)
        plane, resistance = solution.plane - forces.compliance, solution.rate + forces.resistance
        if contacts.kind.size == 0:  # all nodes touch
            plane, resistance = plane - gaps.adds[0, 0], resistance + gaps.adds[0, 1]
        new = find_crests(plane, solution, forces.displacement, crest)
        if new == 0 or not forces.found:
            break
        crests += new
    errors = estimate_errors(solution, steps, polynomial, gaps, contacts, forces, continuum)
    finite = np.isfinite(plane + resistance + errors.compliance + errors.resistance)
    # A mean gap and a resistance are not below 0, where both are smaller than their errors.
    return LoadSolution(
        new == 0 and gaps.found and forces.found and errors.judged and finite,
        max(plane, 0.0),
        max(resistance, 0.0),
        errors.compliance,
        errors.resistance,
        list_contacts(contacts, forces, gaps.opened, solution, continuum.period),
        gaps.uncertain or errors.uncertain,
        residual,
        work,
    )
