"""Boundary elements (Section 5.1): N equal elements, linear pressure, periodic images, mean pressure removed."""

from weier.methods.bem.fields import Field, field
from weier.methods.bem.method import METHOD
from weier.methods.bem.solver import BemCurve, checked_points, curve

__all__ = ["METHOD", "BemCurve", "Field", "checked_points", "curve", "field"]
