"""Loads on the grid, each with what the continuum adds to it (docs/subgrid.md); what fails is solved more finely."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Records
from weier.kernels.jit import kernel
from weier.methods.bem.active_set import GridState, NestedSolver, solve_on_grid
from weier.methods.bem.contact_list import LISTED, list_contacts
from weier.methods.bem.contacts import find_contacts, find_crests
from weier.methods.bem.edges import find_edges, find_steps
from weier.methods.bem.errors import estimate_errors
from weier.methods.bem.grid_solution import Continuum, GridSolution, make_continuum
from weier.methods.bem.grids import Hierarchy
from weier.methods.bem.narrow_gaps import find_gaps
from weier.methods.bem.redistribution import redistribute
from weier.methods.errors import ConvergenceError
from weier.methods.progress import count_load, telling
from weier.theory.waves import MAX_POINTS, Waves

MAX_ROUNDS = 5  # of judging crests again
MAX_PER_WAVE = 64  # nodes for each of the finest waves, beyond which the edges move by many from load to load
RATE_TOLERANCE = 1e-8  # of the rate, how flat A q is in contact: corrections are linear in what is left of it
FINER = (2, 4)  # times the points, for a load that is not verified


class LoadSolution(NamedTuple):
    """One load, with edges of contact between the nodes.

    verified : whether forces were found that are positive, and no crest stands above the plane but those that touch
    plane : mean gap d, in g_0
    resistance : dh/dp, in g_0/p_0*
    compliance_error, resistance_error : estimates, in the same units
    contacts : in the continuum, from left to right, LISTED each; none in full contact
    residual : of the solution on the grid, in g_0
    work : pairs of FFTs
    """

    verified: bool
    plane: float
    resistance: float
    compliance_error: float
    resistance_error: float
    contacts: Records
    residual: float
    work: float


@kernel
def solve_and_correct(
    load: float, heavier: float, flatness: float, carried: Array, deformed: Array, hierarchy: Hierarchy,
    continuum: Continuum, state: GridState,
) -> tuple[bool, bool, float, float, float, float, Records]:  # fmt: skip
    """Go on with one load, its rate to this `flatness`, and what the continuum adds: whether all is done, and what.

    Crests that may touch are told by the plane on the grid at first. The corrected plane and pressure judge all
    crests again, until no more of them may touch.
    """
    grid, points, search = continuum.grid, carried.size, state.search[0]
    done = solve_on_grid(load, heavier, flatness, carried, deformed, hierarchy, grid, state)
    plane, rate = search.plane, search.rate
    if not (done and rate < np.inf):
        return done, False, plane, np.nan, np.nan, np.nan, np.zeros(0, LISTED)
    edge = find_edges(state.contact, state.edge)
    solution = GridSolution(plane, rate, carried, deformed, state.pressure, -state.deformed, state.contact, edge)
    gaps, steps = find_gaps(solution, continuum), find_steps(solution)
    crest = np.zeros(points, np.bool_)
    find_crests(plane, solution, np.zeros(points), crest)
    for _ in range(MAX_ROUNDS):
        contacts, polynomial = find_contacts(crest, gaps, steps, solution, continuum)
        forces = redistribute(contacts, solution, continuum)
        corrected, resistance = plane - forces.compliance, rate + forces.resistance
        if contacts.size == 0:  # all nodes touch
            corrected, resistance = corrected - gaps.runs[0].compliance, resistance + gaps.runs[0].resistance
        new = find_crests(corrected, solution, forces.displacement, crest)
        if not (new and forces.found):
            break
    errors = estimate_errors(solution, steps, polynomial, gaps, contacts, forces, continuum)
    finite = np.isfinite(corrected + resistance + errors.compliance + errors.resistance)
    # A mean gap and a resistance are not below 0, where both are smaller than their errors.
    return (
        True,
        not new and gaps.found and forces.found and errors.judged and finite,
        max(corrected, 0.0),
        max(resistance, 0.0),
        errors.compliance,
        errors.resistance,
        list_contacts(contacts, forces.contacts, gaps.opened, solution, continuum.period),
    )


class GridSolver:
    """One profile on one grid, and what its solution under a load leaves for the next lighter one."""

    def __init__(
        self, profile: Waves, points: int, max_residual: float, rate_tolerance: float = RATE_TOLERANCE
    ) -> None:
        """Make the grids, and room for a solution."""
        self.nested, self._rate_tolerance = NestedSolver(profile, points, max_residual), rate_tolerance
        self._continuum = make_continuum(profile, self.nested.grid)
        self._carried, self._deformed, self._heavier = np.zeros(points), np.zeros(points), np.inf
        # Beyond so many points the edges move by many of them from load to load.
        self._few = points <= MAX_PER_WAVE * profile.waves_per_period[-1]

    def solve(self, load: float) -> LoadSolution:
        """Solve the next lighter load: on the grid, its rate, and what the continuum adds to both."""
        nested = self.nested
        nested.state.search["work"] = 0
        while not (found := solve_and_correct(
            load, self._heavier, self._rate_tolerance, self._carried, self._deformed, nested.hierarchy,
            self._continuum, nested.state,
        ))[0]:  # fmt: skip
            pass
        solution = LoadSolution(*found[1:], nested.residual, nested.work)
        self._heavier = load if self._few and np.isfinite(solution.resistance) else np.inf
        return solution

    def solve_alone(self, load: float) -> LoadSolution:
        """Solve a load independently of all others."""
        self._heavier = np.inf
        return self.solve(load)


def solve_curve(profile: Waves, points: int, max_residual: float, loads: Array) -> list[LoadSolution]:
    """Solve those of increasing loads that leave a gap, from the heaviest down; finer grids are made if needed."""
    rate_tolerance = max(RATE_TOLERANCE, max_residual)  # what it leaves, times the load, is a residual of a height
    found, grid_on = [], cache(lambda count: GridSolver(profile, count, max_residual, rate_tolerance))
    for load in map(float, loads[loads < profile.full_contact_load][::-1]):
        solution = grid_on(points).solve(load)
        check_residual(solution.residual, load, points, max_residual)
        work = solution.work
        for finer in FINER:
            if not solution.verified and points * finer <= MAX_POINTS:
                solution = grid_on(points * finer).solve_alone(load)
                work += finer * solution.work
        solution = solution if solution.verified else _solve_by_patches(profile, load)
        found.append(solution._replace(work=work))
        count_load()
    return found[::-1]


def _solve_by_patches(profile: Waves, load: float) -> LoadSolution:
    """A load that the grids leave in doubt, by the method that needs none; it does not tell forces."""
    from weier.methods import patches  # which begins with boundary elements itself

    try:
        with telling():
            found = patches.curve(profile, [load])
    except (ConvergenceError, ValueError) as error:  # so many waves in so many contacts may not fit into memory
        raise ConvergenceError(
            f"neither boundary elements nor contact patches verify a solution under the mean pressure {load:.6g} "
            f'p_0*: {error}; try more points, or edges="nodes"',
            getattr(error, "residual", np.nan),
        ) from error
    contacts = np.zeros(found.contact_edge.size // 2, LISTED)
    contacts["left"], contacts["right"], contacts["force"] = *found.contact_edge.reshape(-1, 2).T, np.nan
    h, h_error, _, R, R_error = (float(values[0]) for values in found[:5])
    mean_gap, residual = float(profile.total_amplitude) - h, float(found.residual[0])
    return LoadSolution(True, mean_gap, R, h_error, R_error, contacts, residual, 0.0)


def check_residual(residual: float, load: float, points: int, max_residual: float) -> None:
    """Refuse a solution with a residual above the tolerance, in g_0, or without one.

    Raises
    ------
    ConvergenceError
        With this residual.

    """
    if not residual <= max_residual:
        raise ConvergenceError(
            f"boundary elements on {points} points stopped at a residual of {residual:.1e} g_0 under the mean "
            f"pressure {load:.6g} p_0*, above the tolerance {max_residual:.1e}; try other points or a larger "
            "residual_tolerance",
            residual,
        )
