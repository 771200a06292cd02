"""Edges of contact between the nodes: what the continuum adds to a solution on a grid (docs/subgrid.md)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.jit import kernel
from weier.methods.bem.contact_list import ContactList, list_contacts
from weier.methods.bem.contacts import find_contacts, find_crests
from weier.methods.bem.edges import Edges
from weier.methods.bem.errors import estimate_errors
from weier.methods.bem.grid_solution import Continuum, GridSolution
from weier.methods.bem.grids import Grid
from weier.methods.bem.lone_edges import find_steps
from weier.methods.bem.narrow_gaps import Gaps
from weier.methods.bem.redistribution import redistribute

MAX_ROUNDS = 5  # of judging crests again


class Correction(NamedTuple):
    """What the continuum adds to a solution on the grid.

    verified : whether forces were found that are positive, and no crest stands above the plane but those that touch
    compliance, resistance : in g_0 and g_0/p_0*
    compliance_error, resistance_error : estimates
    contacts : in the continuum
    uncertain : whether a contact or a gap may be one too many or too few
    """

    verified: bool
    compliance: float
    resistance: float
    compliance_error: float
    resistance_error: float
    contacts: ContactList
    uncertain: bool


@kernel
def correct_contacts(gaps: Gaps, solution: GridSolution, grid: Grid, edge: Edges, continuum: Continuum) -> Correction:
    """What the continuum adds to a converged solution, whose edges are `edge`, beside what its gaps add.

    Crests that may touch are told by the plane on the grid at first. The corrected plane and pressure judge all
    crests again, until no more of them may touch.
    """
    points = solution.pressure.size
    steps = find_steps(solution, edge)
    crest = np.zeros(points, np.bool_)
    crests = find_crests(solution.plane, solution, np.zeros(points), crest)
    for _ in range(MAX_ROUNDS):
        contacts, polynomial = find_contacts(crest, crests, gaps, steps, solution, edge, continuum)
        forces = redistribute(contacts, solution.plane, solution.rate, grid, continuum)
        compliance = gaps.compliance + forces.compliance
        new = find_crests(solution.plane - compliance, solution, forces.displacement, crest)
        if new == 0 or not forces.found:
            break
        crests += new
    errors = estimate_errors(solution, edge, steps, polynomial, gaps, contacts, forces, continuum)
    return Correction(
        new == 0 and gaps.found and forces.found and errors.judged,
        compliance,
        gaps.resistance + forces.resistance,
        errors.compliance,
        errors.resistance,
        list_contacts(contacts, forces, gaps.opened, solution, continuum.period),
        gaps.uncertain or errors.uncertain,
    )
