"""Contact patches: the exact solution, in which the edges of contact are unknowns.

The method meshes either the contacts, on which the pressure is unknown, or the gaps between them, whichever takes
fewer nodes. Modules, each of which uses only those before it:

chebyshev
    densities with square-root edges on an interval, and their integrals in closed form
surface
    the profile as a cosine series, evaluated from its crests
segments
    contacts or gaps with their Chebyshev nodes
collocation, newton
    the equations on a given number of segments, and Newton's method for them, on few nodes
products, defect_correction
    the same equations without their matrix, and the solution on many nodes, corrected by that on few
fields
    pressure and gap anywhere, from a solution of the equations
initial_guess, start
    the contacts that a load is likely to have, by boundary elements on a coarse grid, or by crests
inequalities, few_contacts
    one load on a few contacts or gaps, whose set is right: Newton's method with a dense matrix
pair_kernel, pair_sums, punch_forces, punches
    any number of contacts or gaps with given edges, by fast sums and conjugate gradients
punch_edges, edge_iteration, punch_inequalities, many_contacts
    one load on any number of contacts or gaps: Newton's method on their edges, and which are missing
solver, event_search
    what users call: curves and solutions, and the loads at which contacts are born or merge
error_model, candidates, method
    what the method costs and how accurate it is, and how the rest of the package chooses and calls it
"""

from weier.methods.patches.event_search import Events, events
from weier.methods.patches.method import METHOD
from weier.methods.patches.solver import Curve, Solution, curve, solve_load, solve_loads

__all__ = ["METHOD", "Curve", "Events", "Solution", "curve", "events", "solve_load", "solve_loads"]
