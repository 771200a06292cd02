"""Convert Datasets to SI units: the variables with a normalised unit, and their attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from weier import units
from weier.checks import shown
from weier.data.variables import CASE, LOADS
from weier.kernels.arrays import Array

if TYPE_CHECKING:
    import xarray as xr

# Normalised units of the scalars that `weier.fields` returns as attributes.
SCALARS = {"mean_pressure": "p_0*", "mean_gap": "g_0"}
LOCATED = (LOADS, "x")  # coordinates in normalised units
CONVERT_DATASET = "convert the whole Dataset first, as in in_si(curve).resistance"


def converted(data: xr.Dataset, scales: Mapping[str, tuple[Array, str]]) -> xr.Dataset:
    """Return a Dataset in SI units; `scales` has the value, or a value per case, and the name of each unit."""
    own_loads = LOADS in data.variables and units.unit_of(data[LOADS]) in units.NORMALISED
    if own_loads and any(value.ndim for value, _ in scales.values()):
        raise ValueError(
            "data must have common pressures in Pa, got traces of several lengths or heights under common loads in "
            "p_0*: solve them by weier.Interface(...).solve([trace, ...], pressures), or convert each case alone, as "
            "in in_si(data.isel(case=[0]))"
        )
    found = data.assign({name: _converted(variable, scales) for name, variable in data.variables.items()})
    if "normalisation" in data.attrs:
        scalars = {name: SCALARS[name] for name in SCALARS.keys() & data.attrs.keys()}
        found.attrs |= {name: data.attrs[name] * float(scales[unit][0]) for name, unit in scalars.items()}
        del found.attrs["normalisation"]
    return found.set_coords(list(data.coords))


def with_pressures_in(data: xr.Dataset, unit: str) -> xr.Dataset:
    """Return curves under loads in Pa with these loads in `unit`; leave them unchanged for "" and p_0*."""
    if unit in ("", units.PASCAL, units.NORMALISED_PRESSURE):
        return data
    given = data[LOADS].values / units.factor("pressure", unit, units.PASCAL)
    return data.assign_coords({LOADS: (LOADS, given, data[LOADS].attrs | {"units": unit})})


def marked(data: xr.Dataset) -> xr.Dataset:
    """Mark each variable in a normalised unit as one that weier made.

    The mark is in the `encoding`. xarray keeps it when values are selected, sorted or joined, and drops it in any
    arithmetic, while it keeps `attrs`. What is read from a file has an encoding, too.
    """
    for variable in data.variables.values():
        if units.unit_of(variable) in units.NORMALISED:
            variable.encoding = {units.NORMALISED_BY: units.unit_of(variable)}
    return data


def check_normalised(data: Any) -> None:
    """Refuse anything but a Dataset in normalised units whose variables are not results of arithmetic."""
    if not hasattr(data, "data_vars"):
        raise ValueError(f"data must be a Dataset of weier, got {shown(data)}: {CONVERT_DATASET}")
    normalised = {name for name, variable in data.variables.items() if units.unit_of(variable) in units.NORMALISED}
    for name, variable in data.variables.items():
        quantity = variable.dtype.kind == "f" and (name in data.data_vars or name in LOCATED)
        # Arithmetic drops attributes in which its operands differ, such as `long_name`, and keeps others.
        plain = variable.attrs.get("units") == units.NONE and "long_name" not in variable.attrs
        lost = quantity and (plain or not units.unit_of(variable))
        if lost or (name in normalised and not variable.encoding):
            raise ValueError(
                f"{name} must be as weier returned it, got values that arithmetic may have changed: convert the "
                "whole Dataset first, and compute with its SI units"
            )
    if not normalised:
        raise ValueError("data must be normalised, got no quantity in units such as p_0*: is it in SI units already?")


def _converted(variable: xr.Variable, known: Mapping[str, tuple[Array, str]]) -> xr.Variable:
    """Return a variable with its attributes, in SI units where it has a normalised unit."""
    import xarray as xr

    attributes = dict(variable.attrs)
    unit = attributes.pop(units.NORMALISED_BY, None)
    if unit not in known:
        return variable
    factor, attributes["units"] = known[unit]
    if "long_name" in attributes:
        attributes["long_name"] = str(attributes["long_name"]).removesuffix(units.in_words(unit))
    found = xr.apply_ufunc(scaled, variable, xr.Variable((CASE,) * factor.ndim, factor))
    return xr.Variable(found.dims, found.values, attributes)


@np.errstate(over="ignore", invalid="ignore")
def scaled(values: Array, unit: Array) -> Array:
    """Return values in a unit; NaN, where a value is missing, stays NaN.

    An infinite resistance is that of no contact, and stays infinite for perfect conductors, too, whose unit is 0.
    """
    return np.where(np.isfinite(values), np.asarray(values, float) * unit, values)
