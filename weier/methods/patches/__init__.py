"""Contact patches: the exact solution, in which the edges of contact are unknowns.

The method meshes either the contacts, on which the pressure is unknown, or the gaps between them, whichever takes
fewer nodes. Modules, each of which uses only those before it:

chebyshev
    densities with square-root edges on an interval, and their integrals in closed form
surface
    the profile as a cosine series, evaluated from its crests
segments
    contacts or gaps with their Chebyshev nodes
collocation, defect_correction
    the equations on a given number of segments with Newton's method for them on few nodes, and without their matrix,
    with the solution on many nodes, corrected by that on few
fields
    pressure and gap anywhere, from a solution of the equations
initial_guess
    the contacts that a load is likely to have, by crests or by boundary elements on a coarse grid
pair_kernel, pair_sums, punch_forces, punches
    any number of contacts or gaps with given edges, by fast sums and conjugate gradients
edge_iteration
    Newton's method on their edges
inequalities
    tension and overlap: which segments are missing, and which must be cut
few_contacts
    one load on a few contacts or gaps, whose set is right, by a dense matrix
many_contacts
    one load on any number of contacts or gaps, whose set is corrected
solver, event_search
    what users call: curves and solutions, and the loads at which contacts are born or merge
error_model, method
    what the method costs and how accurate it is, and how the rest of the package chooses and calls it
"""

from weier.methods.patches.event_search import Events, events
from weier.methods.patches.method import METHOD
from weier.methods.patches.solver import Curve, Solution, curve, solve_load, solve_loads

__all__ = ["METHOD", "Curve", "Events", "Solution", "curve", "events", "solve_load", "solve_loads"]
