"""Pressure, gap and displacement along the surface under one load, their densities, and events over the loads."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from weier import units
from weier.api.progress import shown_progress
from weier.checks import checked_count, checked_numbers, shown
from weier.data import variables
from weier.data.provenance import NORMALISED
from weier.data.si import marked
from weier.kernels.arrays import Array
from weier.methods import bem, patches
from weier.methods.patches.distribution import fraction_above
from weier.surface.loads import checked_load
from weier.surface.waves import MAX_POINTS, Waves, check_resolvable, checked_surface

# The meaning and unit of each variable.
ATTRIBUTES = {
    "x": ("position along the surface", "lambda_0"),
    "pressure": ("contact pressure", "p_0*"),
    "gap": ("gap between rigid plane and surface", "g_0"),
    "displacement": (
        "elastic displacement away from the rigid plane, of mean 0: gap = mean gap - height + displacement",
        "g_0",
    ),
    "left": ("left edge of a contact", "lambda_0"),
    "right": ("right edge of a contact", "lambda_0"),
    "left_strength": ("k_1 at the left edge: p = k_1 s^(1/2) at the distance s inside", "p_0*/lambda_0^(1/2)"),
    "right_strength": ("k_1 at the right edge: p = k_1 s^(1/2) at the distance s inside", "p_0*/lambda_0^(1/2)"),
    "pressure_above": ("fraction of the period under more than this pressure", "1"),
    "pressure_density": ("probability density of the contact pressure between two limits", "1/p_0*"),
    "gap_above": ("fraction of the period with more than this gap", "1"),
    "gap_density": ("probability density of the gap between two limits", "1/g_0"),
    "mean_pressure": ("mean pressure of the event", "p_0*"),
    "birth": ("1 where a contact is born, 0 where two merge", "1"),
    "patch_count": ("contacts in one period just above the event, 0 in full contact", "1"),
}


def fields(profile: Waves, mean_pressure: float, points: int | None = None) -> xr.Dataset:
    """Solve for pressure, gap and displacement along one period at one load, by contact patches.

    Parameters
    ----------
    profile : Profile or Trace
        A surface with a finite number of terms.
    mean_pressure : float
        Positive mean pressure, in p_0*.
    points : int, optional
        Number of positions x in one period; by default 64 for each of the finest waves.

    Returns
    -------
    Dataset
        pressure, in p_0*, gap and displacement, in g_0, over x, in lambda_0; and over the dimension patch the left
        and right edge of each contact, in lambda_0, and the strength k_1 of the pressure there: p = k_1 s^(1/2) at
        the distance s inside an edge, and the gap (4 pi/3) k_1 s^(3/2) outside. The attribute mean_gap is d, in g_0.
        Scalar coordinates hold the profile.

    Raises
    ------
    ValueError
        If the load or the number of points is out of range.
    ConvergenceError
        If the load cannot be solved.

    Examples
    --------
    >>> import weier
    >>> field = weier.fields(weier.Profile(D=1.25, gamma=5, m=2, phases=1.0), 0.1)
    >>> for left, right in zip(field.left.values, field.right.values):
    ...     print(f"contact from {left:.3f} to {right:.3f}")
    contact from 0.142 to 0.164
    contact from 0.937 to 1.008
    >>> print(field.pressure.dims, f"mean gap {field.mean_gap:.3f}")
    ('x',) mean gap 0.784

    """
    load = checked_load(mean_pressure)
    check_resolvable(checked_surface(profile))
    contact = patches.solve_load(profile, load)
    points = int(bem.points_of(profile)) if points is None else checked_count("points", points, 1, MAX_POINTS)
    x = np.linspace(0.0, profile.period, points, endpoint=False)
    curves = {"x": x, "pressure": contact.pressure(x), "gap": contact.gap(x), "displacement": contact.displacement(x)}
    ends = {"left": contact.edges[:, 0], "right": contact.edges[:, 1]}
    ends |= {"left_strength": contact.edge_strength[:, 0], "right_strength": contact.edge_strength[:, 1]}
    return _dataset(profile, {"x": curves, "patch": ends}, mean_pressure=load, mean_gap=contact.mean_gap)


def densities(
    profile: Waves, mean_pressure: float, pressure: ArrayLike | None = None, gap: ArrayLike | None = None
) -> xr.Dataset:
    """Solve for the probability densities of pressure and gap over the period at one load.

    Parameters, exceptions and coordinates are those of `fields`, with the limits of bins in place of points.

    Parameters
    ----------
    profile, mean_pressure : Profile or Trace, float
        Surface and load.
    pressure, gap : array_like, optional
        Increasing limits of bins, at least 0, in p_0* and g_0; by default 100 bins from 0 to the largest value.

    Returns
    -------
    Dataset
        The limits pressure and gap; pressure_above and gap_above, the fractions of the period above each, exact
        whatever the bins; and pressure_density and gap_density in the bins, the differences of these fractions over
        the widths. Their integrals are the contact fraction, an attribute, and the rest of the period. The default
        gap_density of full contact is NaN.

    Examples
    --------
    >>> import weier
    >>> found = weier.densities(weier.Profile(D=1.25, gamma=5, m=2, phases=1.0), 0.1, pressure=[0, 1, 2, 3])
    >>> found.pressure_density.values.round(4), round(found.contact_fraction, 4)
    (array([0.0393, 0.0538, 0.    ]), 0.0931)

    """
    load, values = checked_load(mean_pressure), dict[str, dict[str, np.ndarray]]()
    given = {"pressure": _checked_limits("pressure", pressure, "p_0*"), "gap": _checked_limits("gap", gap, "g_0")}
    check_resolvable(checked_surface(profile))
    contact = patches.solve_load(profile, load)
    for name, limits in given.items():
        limits, above = fraction_above(contact, name == "gap", limits)
        width, within = np.diff(limits), np.maximum(above[:-1] - above[1:], 0.0)
        density = np.divide(within, width, out=np.full(width.shape, np.nan), where=width > 0)
        values |= {
            f"{name}_limit": {name: limits, f"{name}_above": above},
            f"{name}_bin": {f"{name}_density": density},
        }
    fraction = float(2 * contact.half_width.sum() / profile.period) if contact.state else 1.0
    scalars = {"mean_pressure": load, "mean_gap": contact.mean_gap, "contact_fraction": fraction}
    return _dataset(profile, values, **scalars)


def _checked_limits(name: str, limits: ArrayLike | None, unit: str) -> Array | None:
    if limits is None:
        return None
    found = checked_numbers(name, limits, "be finite and at least 0", lambda at: (at >= 0) & (at < np.inf), unit)
    if found.ndim != 1 or found.size < 2 or np.any(np.diff(found) <= 0):
        raise ValueError(f"{name} must be two or more limits of bins, increasing, got {shown(limits)}")
    return found


def events(profile: Waves, low: float, high: float) -> xr.Dataset:
    """Find the mean pressures at which contacts are born or merge.

    Parameters
    ----------
    profile : Profile or Trace
        A surface with a finite number of terms.
    low, high : float
        Ends of the interval of mean pressures, 0 < low < high, in p_0*.

    Returns
    -------
    Dataset
        Over the dimension event, by increasing load: mean_pressure, in p_0*, x, in lambda_0, birth (True) or merger
        (False), and patch_count just above the load, the same for all events of one load. The resistance drops at
        births and has a kink at mergers. Scalar coordinates hold the profile.

    Raises
    ------
    ValueError
        If the loads are not positive and increasing, or there are too many waves.
    ConvergenceError
        If a load of the search cannot be solved.

    Examples
    --------
    >>> import weier
    >>> found = weier.events(weier.Profile(D=1.25, gamma=5, m=2, phases=1.0), 1e-3, 1.0)
    >>> for event in zip(found.mean_pressure.values.round(3), found.birth.values, found.patch_count.values):
    ...     print(*event)
    0.077 True 2
    0.196 True 3
    0.549 True 4
    0.674 False 3
    0.68 True 4
    0.891 False 3

    """
    check_resolvable(checked_surface(profile))
    low, high = checked_load(low, "low"), checked_load(high, "high")
    if not low < high:
        raise ValueError(f"high must exceed low, got {low} and {high}")
    progress = shown_progress("weier.events", 1, "the contact")
    found = patches.events(profile, low, high, report=progress.reach)._asdict()
    return _dataset(profile, {"event": found | {"birth": found["birth"].astype(bool)}})


def _dataset(profile: Waves, values: dict[str, dict[str, np.ndarray]], **attributes: object) -> xr.Dataset:
    """Return a dataset of values over each dimension, with the labels of the profile as coordinates."""
    data = {
        name: (dim, value, units.described(*ATTRIBUTES[name]))
        for dim, own in values.items()
        for name, value in own.items()
    }
    labels = {name: value for name, value in profile.labels.items() if name != "phases"}
    coordinates = {name: ((), value, variables.attributes(name)) for name, value in labels.items()}
    return marked(xr.Dataset(data, coordinates, {"normalisation": NORMALISED, **attributes}))
