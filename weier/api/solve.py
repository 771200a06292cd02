"""`weier.solve`: one curve, or the curves of several profiles and methods in one dataset."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from weier.api.progress import counted, shown_progress
from weier.api.rows import derived
from weier.api.task import CurveTask
from weier.checks import checked_flag, checked_workers, shown
from weier.data import dataset, provenance
from weier.data.bodies import Bodies
from weier.data.selection import name_cases
from weier.data.variables import LOADS, attributes
from weier.kernels.arrays import Array, Indices
from weier.methods.curve import Curve
from weier.methods.load_progress import converting, reporting_to
from weier.methods.registry import METHODS, default_method, find_method
from weier.methods.settings import TOLERANCE, all_settings, checked_settings, described, with_tolerance
from weier.surface.loads import listed_loads, unit_doubt
from weier.surface.waves import Waves, checked_surface
from weier.units import PASCAL


def solve(
    profile: Waves | Sequence[Waves],
    mean_pressure: ArrayLike,
    method: str | Sequence[str] | None = None,
    *,
    contact_edges: bool = False,
    workers: int = 1,
    **settings: Any,
) -> xr.Dataset:
    """Solve the contact of profiles with a plane: compliance and contact resistance over the load.

    Parameters
    ----------
    profile : Profile, Trace or sequence of these
        The Weierstrass series, or measured heights (methods "bem", "patches" and "auto").
    mean_pressure : array_like, shape (loads,)
        Positive mean pressures, in p_0*, in any order. The result keeps the order; duplicates are solved once.
    method : str or sequence of str, optional
        By default "patches", or "auto" if a tolerance is given. One of

        {methods}
    contact_edges : bool
        Whether to return the edges of all contacts, over the dimension `edge`.
    workers : int
        Number of processes for lists of curves; -1 for one per core. Results do not depend on it. A process starts in
        about three seconds. A script must call `solve` below `if __name__ == "__main__":`, since each process imports
        it. Standard error shows the progress every ten seconds.
    **settings
        Settings of the method; with a list of methods, under the name of each, as `layer={"points": 48}`. A common
        `tolerance`, the accepted error of the compliance in g_0, applies to all methods that take one. Settings and
        defaults:

        {settings}

    Returns
    -------
    Dataset
        For one profile and one method: compliance, in g_0, resistance, in g_0/p_0*, and other variables of the method
        over mean_pressure (see the table of variables). Scalar coordinates hold the profile; attributes hold settings
        with defaults, versions and seconds. `weier.Interface.in_si` converts to Pa, m and ohm m^2, or K m^2/W for
        heat.

        For lists: over case, solution_method and mean_pressure, as in the pipeline. Unsolved values are NaN, with
        `status` and a warning that gives the reason.

    Raises
    ------
    ValueError
        If the loads, the method or a setting is unknown or out of range; NotApplicableError if the method does not
        apply to the profile; OutOfReachError if a tolerance cannot be met.
    ConvergenceError
        If a solver misses its tolerance.
    KeyboardInterrupt, TimeoutError
        At Ctrl-C, or as raised by a handler of signals, such as one of `signal.alarm`. The attribute `curve` of the
        exception is the result so far, for increasing loads: of one curve, the loads that "patches", "bem" or "auto"
        has solved; of a list, the cases. It is None if there is none.
    ChildProcessError
        If a process terminates early, for example without the guard named above.

    Notes
    -----
    Results at a load do not depend on the other loads, except for the bound on the error of the resistance by
    boundary elements, which more loads make tighter.

    Examples
    --------
    >>> import weier
    >>> profile = weier.Profile(D=1.25, gamma=5, m=3, phases=(0.0, 1.0, 2.0))
    >>> curve = weier.solve(profile, [0.01, 0.1, 1.0], method="demelio")
    >>> curve.compliance.values.round(4)
    array([0.0706, 0.4208, 1.3527])
    >>> rougher = weier.Profile(D=1.5, gamma=5, m=3, phases=(0.0, 1.0, 2.0))
    >>> both = weier.solve([profile, rougher], [0.01, 0.1, 1.0], method=["archard", "demelio"])
    >>> print(both.compliance.dims, both.D.values)
    ('case', 'solution_method', 'mean_pressure') [1.25 1.5 ]

    """
    loads, position = listed_loads(mean_pressure)
    curves = solve_under(profile, loads, None, method, contact_edges=contact_edges, workers=workers, **settings)
    return in_order(curves, position)


def in_order(curves: xr.Dataset, position: Indices) -> xr.Dataset:
    """Return curves under increasing loads in the order in which the loads were given."""
    return curves if np.array_equal(position, range(curves.sizes[LOADS])) else curves.isel({LOADS: position})


def solve_under(
    profile: Waves | Sequence[Waves],
    loads: Array,
    bodies: Bodies | None,
    method: str | Sequence[str] | None = None,
    *,
    contact_edges: bool = False,
    workers: int = 1,
    **settings: Any,
) -> xr.Dataset:
    """Solve under increasing loads, in p_0* or, for two bodies, in Pa; the other arguments are as in `solve`."""
    edges, workers = checked_flag("contact_edges", contact_edges), checked_workers(workers)
    argument = "profile" if bodies is None else "surface"  # as `Interface.solve` calls it
    profiles = [checked_surface(one, argument) for one in _list(argument, profile)]
    own_loads = [loads if bodies is None else bodies.at(one).normalised_pressure(loads) for one in profiles]
    for surface, own in zip(profiles, own_loads, strict=True):
        if doubt := unit_doubt(surface, own, bodies is not None):
            warnings.warn(doubt, stacklevel=3)  # points to the call of `solve`
    method = default_method(*profiles, within_tolerance=TOLERANCE in settings) if method is None else method
    methods = [find_method(name).name for name in _list("method", method)]
    several = isinstance(profile, list | tuple) or isinstance(method, list | tuple)
    checked = settings_by_method(methods, settings if several else {methods[0]: settings})
    for surface in profiles:  # before anything is solved
        for name in methods:
            if (applied := find_method(name)).takes(surface):
                applied.check(surface, **checked.get(name, {}))
    if not several:
        curve = CurveTask(profiles[0], methods[0], checked[methods[0]], own_loads[0])
        return _solve_one(curve, edges, loads if bodies else None)
    from weier.api.batch import solve_batch  # imports the scenes, which a single curve does not need
    from weier.scene.case import Case

    cases = [Case(surface.parameters, tuple(methods), checked, surface) for surface in profiles]
    title = f"{len(cases)} profile{'s' * (len(cases) > 1)} by {', '.join(dict.fromkeys(methods))}"

    def named(data: xr.Dataset) -> xr.Dataset:
        return name_cases(data.assign_attrs(provenance.result_attributes(), title=title))

    with converting(named):
        data = solve_batch(cases, loads, edges, workers, own_loads if bodies else None)
    return named(data)


def _list(name: str, given: Any) -> list[Any]:
    listed = list(given) if isinstance(given, list | tuple) else [given]
    if not listed:
        raise ValueError(f"{name} must have at least one element, got an empty list")
    return listed


def _solve_one(curve: CurveTask, edges: bool, pressures: Array | None) -> xr.Dataset:
    """Return one curve with its labels and settings, over mean_pressure, or over the same pressures in Pa."""

    def labelled(loads: Array, solution: Curve, **others: Any) -> xr.Dataset:
        found = solution.values() | derived(curve.profile, loads, solution)
        values = {name: value for name, value in found.items() if edges or np.ndim(value) < 2}
        labels = curve.profile.labels | {"phases": curve.profile.listed_phases, "solution_method": curve.method}
        settings = all_settings(find_method(curve.method), curve.settings)
        data = dataset.curve(loads, values | others, labels, settings)
        if pressures is None:
            return data
        exact = pressures[np.searchsorted(curve.loads, loads)]
        return data.assign_coords({LOADS: (LOADS, exact, attributes(LOADS, unit=PASCAL))})

    count = curve.loads.size
    progress = shown_progress("weier.solve", count, counted(count, "load"), curve.expected)
    with converting(lambda solved: labelled(*solved)), reporting_to(progress):
        solution, seconds = curve.solve()
    return labelled(curve.loads, solution, seconds=seconds)


def settings_by_method(methods: Sequence[str], settings: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the checked settings of several methods; a tolerance applies to all methods that take one."""
    tolerance = settings.get(TOLERANCE)
    settings = {name: own for name, own in settings.items() if name != TOLERANCE}
    for name, own in settings.items():
        if not isinstance(own, Mapping):
            raise ValueError(
                f'settings of several methods must be given by the method, such as layer={{"points": 48}}, got '
                f"{name}={shown(own)} for {', '.join(methods)}"
            )
        if name not in methods:
            raise ValueError(f"settings were given for method {name!r}, which is not run, only {', '.join(methods)}")
    given = with_tolerance(methods, settings, tolerance)
    return {name: checked_settings(find_method(name), own) for name, own in given.items()}


def _listed(lines: Iterable[str]) -> str:
    """Return lines of a list, for the docstring."""
    return "\n        ".join(f"* {line}." for line in lines)


solve.__doc__ = (
    str(solve.__doc__)
    .replace("{methods}", _listed(f'"{method.name}": {method.summary}' for method in METHODS))
    .replace("{settings}", _listed(f"{name}: {meaning}" for name, meaning in described(METHODS)))
)
