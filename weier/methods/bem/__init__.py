"""Boundary elements (Section 5.1): N equal elements, linear pressure, periodic images, mean pressure removed."""

from weier.methods.bem.curve import Curve, checked_points, curve
from weier.methods.bem.field import Field, field

__all__ = ["Curve", "Field", "checked_points", "curve", "field"]
