"""Contact patches: the exact solution, with unknowns only where there is contact, or only where there is a gap."""

from weier.methods.patches.curve import Curve, curve, solve_load, solve_loads
from weier.methods.patches.history import Events, events
from weier.methods.patches.method import METHOD
from weier.methods.patches.solution import Solution

__all__ = ["METHOD", "Curve", "Events", "Solution", "curve", "events", "solve_load", "solve_loads"]
