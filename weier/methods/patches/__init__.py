"""Contact patches: exact solution with the edges of contact as unknowns (docs/patches.md).

Each module names its sections of that page. `surface` is the profile as a cosine series about its crests; `segments`
holds contacts or gaps with their nodes and densities. A load starts from `start`. `given_edges` (with `kind`,
`contacts`, `gaps`, `rule`, `pair_sums`) solves on given edges, `edge_iteration` moves them, `inequalities` (with
`pressure_and_gap`) finds missing segments, and `stages` is the iteration over these. `thin_gaps` are cracks in closed
form, and `certificate` bounds the error of h and estimates the error of R. `solver` and `event_search` are the
interface.
"""

from weier.methods.patches.event_search import Events, events
from weier.methods.patches.solver import METHOD, Solution, curve, solve_load, solve_loads
from weier.methods.patches.start import TOLERANCE

__all__ = [
    "METHOD",
    "TOLERANCE",
    "Events",
    "Solution",
    "curve",
    "events",
    "solve_load",
    "solve_loads",
]
