"""Elastic contact stiffness and electrical contact resistance of the Weierstrass profile."""

from weier.errors import ConvergenceError
from weier.profile import Profile, random_phases

__all__ = ["ConvergenceError", "Profile", "random_phases"]
