"""Elastic contact stiffness and electrical contact resistance of the Weierstrass profile.

The public names are imported when they are first used: xarray, pandas and numba take a second, and the version or
the help of a command needs none of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from weier.data.provenance import VERSION

if TYPE_CHECKING:
    from weier.api.fields import densities as densities
    from weier.api.fields import events as events
    from weier.api.fields import fields as fields
    from weier.api.interface import Interface as Interface
    from weier.api.inverse import find_load as find_load
    from weier.api.solve import solve as solve
    from weier.data.dataset import open_dataset as open_dataset
    from weier.figures.scene_checks import load_scene as load_scene
    from weier.methods.auto import choose as choose
    from weier.methods.errors import ConvergenceError as ConvergenceError
    from weier.methods.errors import NotApplicableError as NotApplicableError
    from weier.methods.errors import OutOfReachError as OutOfReachError
    from weier.surface.gaussian import gaussian as gaussian
    from weier.surface.measured.trace import Trace as Trace
    from weier.surface.profile import Profile as Profile
    from weier.surface.profile import random_phases as random_phases
    from weier.surface.spectrum import fit as fit

__version__ = VERSION

_MODULES = {
    "ConvergenceError": "methods.errors",
    "Interface": "api.interface",
    "NotApplicableError": "methods.errors",
    "OutOfReachError": "methods.errors",
    "Profile": "surface.profile",
    "Trace": "surface.measured.trace",
    "choose": "methods.auto",
    "densities": "api.fields",
    "events": "api.fields",
    "fields": "api.fields",
    "find_load": "api.inverse",
    "fit": "surface.spectrum",
    "gaussian": "surface.gaussian",
    "load_scene": "figures.scene_checks",
    "open_dataset": "data.dataset",
    "random_phases": "surface.profile",
    "solve": "api.solve",
}
__all__ = sorted([*_MODULES, "__version__"])


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
