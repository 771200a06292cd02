"""Contact patches: the exact solution, with unknowns only where there is contact, or only where there is a gap."""

from weier.patches.curve import Curve, curve, solve_load, solve_loads
from weier.patches.history import Events, events
from weier.patches.solution import Solution

__all__ = ["Curve", "Events", "Solution", "curve", "events", "solve_load", "solve_loads"]
