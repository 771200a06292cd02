"""The non-linear layer model (4.3): each wave bears on the half-plane through a layer of all finer waves.

docs/layer.md derives the formulas; each module names its sections.
"""

from weier.methods.layer.nonlinear_layer import METHOD, POINTS, curve

__all__ = ["METHOD", "POINTS", "curve"]
