"""The infinite series: its coarse terms resolved, all finer ones as the non-linear layer under each point.

The formulas are derived in docs/hybrid.md; each module names the sections that it rests on.

The first k waves are solved by boundary elements on a layer that yields by w(p) = g_k W(p/p_k*), where W is the
closure of the layer model for the infinite series (4.3), the fixed point of one scale. At every node

    w(p) + A p = z - H  where p > 0,    z - A p - H < 0  where p = 0,

with H the height of the rigid plane. One number s at a node says both: s = w(p) + c p in contact, the negative gap
outside, with c the influence of a node on itself. For k = 1 this is the layer model itself; the more terms are
resolved, the less is left to the layer. Beside it stand the limits of the bounds theorem, which a plain grid finds
for more terms than this method can resolve.
"""

from weier.methods.hybrid.method import METHOD
from weier.methods.hybrid.solver import HybridCurve, curve
from weier.methods.hybrid.truncation_bounds import bounds

__all__ = ["METHOD", "HybridCurve", "bounds", "curve"]
