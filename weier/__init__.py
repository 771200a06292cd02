"""Elastic contact stiffness and electrical contact resistance of the Weierstrass profile."""

from weier.conduction import Interface
from weier.errors import ConvergenceError
from weier.fields import events, fields
from weier.profile import Profile, random_phases
from weier.solve import solve
from weier.version import VERSION

__version__ = VERSION

__all__ = ["ConvergenceError", "Interface", "Profile", "__version__", "events", "fields", "random_phases", "solve"]
