"""One profile, one method, many loads: the public way in."""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter
from typing import Any

import xarray as xr
from numpy.typing import ArrayLike

from weier.data import dataset
from weier.kernels.arrays import Array
from weier.kernels.jit import compiling_seconds
from weier.methods.method import Method
from weier.methods.registry import DEFAULT, METHODS, find_method
from weier.methods.settings import checked_settings
from weier.theory.loads import checked_loads
from weier.theory.profile import Profile, checked_profile


def solve(profile: Profile, mean_pressure: ArrayLike, method: str = DEFAULT, **settings: Any) -> xr.Dataset:
    """Compliance and contact resistance of a profile pressed against a plane.

    Parameters
    ----------
    profile : Profile
        The Weierstrass series.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    method : str
        {methods}
    **settings
        Settings of the method, such as `points` of "bem"; attributes of the result.

    Returns
    -------
    Dataset
        Over the dimension mean_pressure: compliance, in g_0, and resistance, in g_0/p_0*; and
        whatever else the method returns: see the table of variables. The attribute seconds is the time it took.

    Raises
    ------
    ValueError
        If the loads, the method or a setting is unknown or out of range; NotApplicableError where the method
        does not apply to the profile.
    ConvergenceError
        If a solver misses its tolerance.

    Examples
    --------
    >>> import weier
    >>> profile = weier.Profile(D=1.25, gamma=5, m=3, phases=(0.0, 1.0, 2.0))
    >>> curve = weier.solve(profile, [0.01, 0.1, 1.0], method="demelio")
    >>> curve.compliance.values.round(4)
    array([0.0706, 0.4208, 1.3527])

    """
    loads, solver = checked_loads(mean_pressure), find_method(method)
    settings = checked_settings(solver, settings)
    checked_profile(profile)
    solution, seconds = solve_checked(profile, loads, solver, settings)
    return dataset.curve(loads, solution._asdict(), {"method": method, **settings, "seconds": seconds})


def solve_checked(profile: Profile, loads: Array, method: Method, settings: Mapping[str, Any]) -> tuple[Any, float]:
    """What `solve` holds, as the method's own tuple of arrays and scalars, and the seconds without compiling.

    Loads and names of settings are checked already.
    """
    method.applies(profile)
    start, compiling = perf_counter(), compiling_seconds()
    solution = method.solve(profile, loads, **settings)
    return solution, perf_counter() - start - (compiling_seconds() - compiling)


def _summaries(indent: str) -> str:
    """A line for each method, for the docstring."""
    return f"\n{indent}".join(f'"{method.name}": {method.summary}.' for method in METHODS)


solve.__doc__ = str(solve.__doc__).replace("{methods}", _summaries(" " * 8))
