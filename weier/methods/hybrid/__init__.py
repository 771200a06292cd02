"""The infinite series with its coarse terms resolved by boundary elements on the non-linear layer of all finer ones.

docs/hybrid.md derives the formulas; each module names its sections. `closure` is the layer at a node, `newton` solves
the equations, and `solver` adds the bounds (27) from the resolved terms alone.
"""

from weier.methods.hybrid.method import METHOD, SECONDS
from weier.methods.hybrid.solver import HybridCurve, bounds, curve

__all__ = ["METHOD", "SECONDS", "HybridCurve", "bounds", "curve"]
