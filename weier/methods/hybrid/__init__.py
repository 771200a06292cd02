"""The whole series, m = inf: its coarse terms resolved, all finer ones as the non-linear layer under each point.

The first k waves are solved by boundary elements on a layer that yields by w(p) = g_k W(p/p_k*), where W is the
layer model's law of the endless series (4.3), the fixed point of one level. At every node

    w(p) + A p = z - flat  where p > 0,    z - A p - flat < 0  where p = 0,

and one number s at a node says both: s = w(p) + c p in contact, the negative gap outside, so that w, p and their
slopes are continuous in s and Newton's method needs no set of active nodes. For k = 1 this is the layer model itself;
the more terms are resolved, the less is left to it. Beside it stand the bounds theorem's rigorous limits, which a
plain grid finds for more terms than the layer can be laid under.
"""

from weier.methods.hybrid.method import METHOD
from weier.methods.hybrid.solver import Curve, curve
from weier.methods.hybrid.truncation_bounds import bounds

__all__ = ["METHOD", "Curve", "bounds", "curve"]
