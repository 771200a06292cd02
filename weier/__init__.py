"""Elastic contact stiffness and electrical contact resistance of the Weierstrass profile."""

from weier.conduction import Interface
from weier.contact import Contact, open
from weier.errors import ConvergenceError
from weier.fields import events, fields
from weier.phases import random_phases
from weier.plan_scene import plan
from weier.profile import Profile
from weier.solve import solve
from weier.version import VERSION

__version__ = VERSION

__all__ = [
    "Contact",
    "ConvergenceError",
    "Interface",
    "Profile",
    "__version__",
    "events",
    "fields",
    "open",
    "plan",
    "random_phases",
    "solve",
]
