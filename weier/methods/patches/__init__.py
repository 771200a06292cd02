"""Contact patches: the exact solution, in which the edges of contact are unknowns.

The formulas and the algorithm are derived in docs/patches.md; each module names the sections that it rests on.

The method meshes either the contacts, on which the pressure is unknown, or the gaps between them, whichever takes
fewer nodes. Each load is solved by itself:

1. Boundary elements on a coarse grid, or crests where contacts are tiny, give the contacts that the load is likely to
   have (`start`).
2. On given edges the density is a linear problem, solved directly for few contacts and by conjugate gradients with
   fast sums for many (`given_edges`, `pair_sums`). Its singularities at the edges determine how these must move, as
   in Newton's method (`edge_iteration`).
3. Tension on a contact or overlap outside shows that the set of contacts is wrong (`inequalities`). Then contacts are
   cut, added, removed and merged, and step 2 begins anew (`many_contacts`).
4. The residuals of all conditions, evaluated at other points from closed forms (`fields`), certify the solution and
   bound the error of its compliance (`inequalities`). From that follows the error of the resistance
   (`resistance_error`).

Modules, each of which uses only those before it:

surface
    the profile as a cosine series, evaluated from its crests
segments
    contacts or gaps with their Chebyshev nodes, and the densities on them: the state that each step begins and ends
    with
pair_sums
    sums over all pairs of nodes, in a time that grows as their number does
fields
    pressure and gap anywhere, from a density
kind, contacts, gaps, rule
    contacts and gaps as two objects with one interface, and the arrays of their discrete problem
given_edges, edge_iteration
    any number of contacts or gaps: their pressure, and Newton's method on their edges
inequalities
    which segments are missing or must be cut, and what a solution violates
many_contacts
    one load on any number of contacts or gaps, whose set is corrected
certificate
    what a solution violates, and a bound on its error
resistance_error
    how far the resistance of a state may be off
start
    guesses, from which each load starts
solver, event_search
    what users call: curves and solutions; and the loads at which contacts are born or merge
method
    how the rest of the package chooses and calls it
"""

from weier.methods.patches.event_search import Events, events
from weier.methods.patches.method import METHOD, run_kernels
from weier.methods.patches.solver import TOLERANCE, PatchCurve, Solution, curve, solve_load, solve_loads
from weier.methods.patches.start import MAX_TOLERANCE, MIN_TOLERANCE

__all__ = [
    "MAX_TOLERANCE",
    "METHOD",
    "MIN_TOLERANCE",
    "TOLERANCE",
    "Events",
    "PatchCurve",
    "Solution",
    "curve",
    "events",
    "run_kernels",
    "solve_load",
    "solve_loads",
]
