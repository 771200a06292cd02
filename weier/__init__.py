"""Elastic contact stiffness and electrical contact resistance of the Weierstrass profile."""

from weier.data.provenance import VERSION
from weier.data.results import Contact, open
from weier.methods.errors import ConvergenceError
from weier.methods.fields import events, fields
from weier.methods.solve import solve
from weier.pipeline.plan import plan
from weier.theory.conduction import Interface
from weier.theory.phases import random_phases
from weier.theory.profile import Profile

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
