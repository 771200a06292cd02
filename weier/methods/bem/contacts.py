"""What the grid knows of each contact, and of each crest that may touch between its nodes."""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices, Record, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.bem.active_set import dot
from weier.methods.bem.edges import CURVATURE, correct_edge
from weier.methods.bem.grid_solution import Continuum, GridSolution, next_node
from weier.methods.bem.grids import copy_values
from weier.methods.bem.interaction import add_grid_moments
from weier.methods.bem.local_fit import (
    EDGE,
    MAX_BEYOND,
    MIN_POLYNOMIAL,
    TERMS,
    added_by_triangles,
    fit_without,
    margin_of,
    remainder,
    scale_of,
    side_margin,
    without_own,
)
from weier.methods.bem.narrow_contacts import contact_edges, highest
from weier.methods.bem.narrow_gaps import Gaps

WIDE, NARROW, CREST = 0, 1, 2
MAX_OTHERS = 100  # on either side, whose effects are summed: they fall inversely with the distance, or faster

# A contact on the grid, or a crest between its contacts:
#
# kind : WIDE, NARROW if it has polynomials, or CREST if it is no contact on the grid but may be one
# position : of the middle, in lambda_0
# force, share : on the grid, per period, and its rate per mean pressure
# self_compliance : displacement per force of its own on the grid, in g_0/p_0* per lambda_0
# edge_compliance, edge_resistance : what its lone edges add to compliance and resistance
# left_compliance, right_compliance : what the left and the right edge add to the compliance, if they are lone ones
# edge_drop, edge_yield : by how much one step of these lowers the resistance, and more force does, per force
# edge_error : what they add to the compliance at most, or, where their steps are uneven, what these take
# left, right : its edges by themselves, or those of narrow gaps beside it, in lambda_0
# closed_after : whether the gap after it is closed in the continuum
# origin, scale : of the variable s of the polynomials, in lambda_0
# limit : how far from the origin it may reach as long as its polynomials mean anything, in s
# centre, half_width : where the search for its edges begins, in s
# height, rate : polynomials of the surface as this contact sees it and of A q of the others, shape (TERMS,)
# height_rest, rate_rest : two terms beyond these, as polynomials, shape (2, TERMS + 2)
# grid_mixed, grid_cross : energies of its force, and of its share, with A q of the others
# force_moments, share_moments : first to third moments of force and share about `position`, shape (3,)
CONTACT = record_type(
    ("kind", np.int64, ()),
    ("closed_after", np.bool_, ()),
    ("position force share self_compliance left right origin scale limit centre half_width", np.float64, ()),
    ("edge_compliance edge_resistance edge_drop edge_yield edge_error grid_mixed grid_cross", np.float64, ()),
    ("left_compliance right_compliance", np.float64, ()),
    ("height rate", np.float64, (TERMS,)),
    ("height_rest rate_rest", np.float64, (2, TERMS + 2)),
    ("force_moments share_moments", np.float64, (3,)),
)


@kernel
def find_contacts(
    crest: Flags, gaps: Gaps, steps: Records, solution: GridSolution, continuum: Continuum
) -> tuple[Records, Flags]:
    """All contacts and the marked crests, from left to right, and which contacts and gaps have polynomials."""
    edge, points = solution.edge, solution.pressure.size
    runs = edge.size - 2
    polynomial = gaps.polynomial.copy()
    contacts = np.zeros(runs // 2 + np.count_nonzero(crest), CONTACT)
    contact_of = np.zeros(runs, np.int64)  # of a gap, the one before it
    used = 0
    for run in range(runs):
        start, nodes = edge[run + 1] % points, edge[run + 2] - edge[run + 1]
        if solution.contact[start]:
            contact_of[run] = used
            polynomial[run] = enter_contact(run, polynomial[run], solution, continuum, contacts[used])
            used += 1
            continue
        for node in range(start, start + nodes):
            if crest[node % points]:
                enter_crest(node % points, solution, continuum, contacts[used])
                used += 1
    for run in range(runs):
        before = after = run  # of gaps between its nodes; what a narrow gap adds belongs half to each side of it
        if not solution.contact[edge[run + 1] % points]:
            contact_of[run] = contact_of[run - 1]
            before, after = run - 1, (run + 1) % runs
        for beside in (contact_of[before], contact_of[after]):
            contacts[beside].edge_compliance += gaps.runs[run].compliance / 2
            contacts[beside].edge_resistance += gaps.runs[run].resistance / 2
        alone = not (polynomial[run] or polynomial[run - 1])  # else its edge belongs to a narrow contact or gap
        place_edge(run, alone, steps[run], gaps.runs, solution, continuum, contacts[contact_of[run]])
    return contacts, polynomial


@kernel
def enter_contact(run: int, polynomial: bool, solution: GridSolution, continuum: Continuum, contact: Record) -> bool:
    """Enter a contact; whether it has a polynomial, as it should if `polynomial`."""
    edge, points = solution.edge, solution.pressure.size
    start, nodes = edge[run + 1] % points, edge[run + 2] - edge[run + 1]
    spacing = continuum.period / points
    run_nodes = np.arange(start, start + nodes) % points
    force, share = spacing * solution.pressure[run_nodes], spacing * solution.per_load[run_nodes]
    half_width = ((nodes - 1) / 2 + EDGE) * spacing
    contact.kind = WIDE
    contact.position = (start + (nodes - 1) / 2) * spacing
    contact.force = force.sum()
    contact.share = share.sum()
    contact.self_compliance = -2 * np.log(np.sin(min(np.pi * half_width / continuum.period, np.pi / 2)))
    margin = margin_of(edge, run)
    if not polynomial or nodes + 2 * margin < MIN_POLYNOMIAL or not contact.share > 0:
        return False
    scale = enter_polynomials(start, margin, force, share, solution, continuum, contact)
    reach, limit = ((nodes - 1) / 2 + EDGE) / scale, ((nodes - 1) / 2 + MAX_BEYOND) / scale
    centre, width, found = contact_edges(contact.height, contact.force, 0.0, reach)
    if not found or abs(centre) + width > limit:
        return False
    contact.kind, contact.limit = NARROW, limit
    contact.centre, contact.half_width = centre, width
    contact.position += centre * scale * spacing
    others = without_own(solution.displacement, share, continuum.influence, start, 0, np.arange(nodes))
    smoothing = added_by_triangles(contact.rate, nodes, scale)
    contact.grid_mixed, contact.grid_cross = dot(force, others + smoothing), dot(share, others + smoothing / 2)
    contact.self_compliance = dot(share, solution.displacement[run_nodes] - others) / contact.share**2
    for i in range(nodes):
        x = (i - (nodes - 1) / 2 - centre * scale) * spacing
        add_grid_moments(force[i], x, spacing, contact.force_moments)
        add_grid_moments(share[i], x, spacing, contact.share_moments)
    return True


@kernel
def enter_crest(node: int, solution: GridSolution, continuum: Continuum, contact: Record) -> None:
    """Enter a crest, by the highest of its nodes."""
    none, margin = np.zeros(1), side_margin(node, solution.contact)
    scale = enter_polynomials(node, margin, none, none, solution, continuum, contact)
    contact.kind, contact.limit, contact.centre = CREST, 1.0, highest(contact.height, 1 / scale)
    contact.position = contact.origin + contact.centre * contact.scale


@kernel
def enter_polynomials(
    start: int, margin: int, force: Array, share: Array, solution: GridSolution, continuum: Continuum,
    contact: Record,
) -> float:  # fmt: skip
    """Fit the surface as a contact with these nodal forces sees it, and A q of the others; the nodes in one s.

    The fit is to the nodes of the contact, which begins at `start`, and some more at both ends. The next two terms of
    each polynomial are entered, too.
    """
    nodes, spacing, windows = force.size, continuum.period / solution.pressure.size, continuum.windows
    window, influence = nodes + 2 * margin, continuum.influence
    copy_values(fit_without(solution.deformed, -force, influence, start, margin, windows), contact.height)
    copy_values(fit_without(solution.displacement, share, influence, start, margin, windows), contact.rate)
    remainder(contact.height, windows, window, continuum.angle, contact.height_rest)
    remainder(contact.rate, windows, window, continuum.angle, contact.rate_rest)
    contact.origin = (start + (nodes - 1) / 2) * spacing
    contact.scale = scale_of(window) * spacing
    return scale_of(window)


@kernel
def place_edge(
    run: int, alone: bool, step: Record, gaps: Records, solution: GridSolution, continuum: Continuum,
    contact: Record,
) -> None:  # fmt: skip
    """Place the edge at which a run begins: at that of a narrow gap, or by itself if no narrow run has it."""
    points, node, compliance = solution.pressure.size, solution.edge[run + 1], 0.0
    begins = solution.contact[node % points]  # a contact begins here
    position = gaps[run - 1].right if begins else gaps[run].left
    if alone:
        compliance, resistance = correct_edge(step)
        contact.edge_compliance += compliance
        contact.edge_resistance += resistance
        contact.edge_drop += step.drop
        contact.edge_error += step.drop * step.load * (1.0 if step.uneven else 2 * CURVATURE)
        if step.load > 0:
            contact.edge_yield += step.drop / (step.load * contact.share)
        beyond = step.position + EDGE
        position = (node - beyond if begins else node - 1 + beyond) * continuum.period / points
    elif run == 0 and begins:  # the gap before it ends in the next period
        position -= continuum.period
    if run == 0 and not begins:  # the contact before it ends there
        position += continuum.period
    if begins:
        contact.left, contact.left_compliance = position, compliance
    else:
        contact.right, contact.right_compliance = position, compliance
        contact.closed_after = gaps[run].left == gaps[run].right


@kernel
def nearest_others(at: int, count: int) -> Indices:
    """Up to `MAX_OTHERS` of so many contacts on either side of one."""
    others = min(count - 1, 2 * MAX_OTHERS)
    index = np.arange(at - others // 2, at - others // 2 + others + 1) % count
    return index[index != at]


@kernel
def displacement_by_edges(contact: Record, position: float, period: float) -> tuple[float, float]:
    """How far lone edges displace a place beside their contact, more than on the grid; and how far at most.

    An edge that is not where the grid has it raises the plane by some H. The change of pressure is most singular
    at this edge, and displaces the contact evenly. At the distance d from the middle of the contact the right edge
    displaces the surface by H (r/cos(alpha) - 1), the left one by H (1/(r cos(alpha)) - 1), with the half-width a,
    r^2 = sin(theta + alpha)/sin(theta - alpha), theta = pi d/L and alpha = pi a/L (docs/subgrid.md).
    """
    if not contact.share > 0:
        return 0.0, 0.0
    alpha, theta = np.arcsin(np.exp(-contact.self_compliance / 2)), np.pi / period * (position - contact.position)
    root = np.sqrt(max(np.sin(theta + alpha) / np.sin(theta - alpha), 0.0))
    of_right, of_left = root / np.cos(alpha) - 1, 1 / (root * np.cos(alpha)) - 1
    displacement = contact.left_compliance * of_left + contact.right_compliance * of_right
    at_most = contact.edge_error * max(abs(of_left), abs(of_right))
    return -displacement * period / contact.share, at_most * period / contact.share


@kernel
def find_crests(plane: float, solution: GridSolution, displacement: Array, crest: Flags) -> bool:
    """Mark the crests in the gaps that may touch between two nodes; whether any is new.

    The node of such a crest is the highest of three, and no farther below the plane than they bend. The surface is
    displaced by so much more than on the grid.
    """
    points, new = crest.size, False
    for node in range(points):
        right = next_node(node, points)
        if solution.contact[node - 1] or solution.contact[node] or solution.contact[right]:
            continue
        before = solution.deformed[node - 1] - displacement[node - 1]
        here = solution.deformed[node] - displacement[node]
        after = solution.deformed[right] - displacement[right]
        if before <= here and after < here and plane - here < 2 * here - before - after:
            known = False
            for beside in range(-2, 3):
                known |= crest[(node + beside) % points]
            if not known:
                crest[node] = new = True
    return new
