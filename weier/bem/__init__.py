"""Boundary elements (Section 5.1): N equal elements, linear pressure, periodic images, mean pressure removed."""

from weier.bem.curve import Curve, checked_points, curve, full_contact_load
from weier.bem.field import Field, field

__all__ = ["Curve", "Field", "checked_points", "curve", "field", "full_contact_load"]
