"""Units that values carry: the attribute `units` of xarray and pandas, and quantities of pint, astropy and unyt.

Normalised units, such as p_0*, equal only themselves, and have an attribute of their own, `normalised_by`.
All others are parsed by pint, which is imported when a value has a unit other than the expected one, since that takes
half a second.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Mapping
from functools import cache
from tokenize import TokenError
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pint

NONE = "1"  # The unit of plain numbers.
WITHOUT = ("", NONE, "dimensionless")
NORMALISED_PRESSURE = "p_0*"
NORMALISED_BY = "normalised_by"  # attribute of a normalised unit, since `units` must be known to UDUNITS
PASCAL, METRE, OHM_METRE, RADIAN = "Pa", "m", "ohm m", "rad"
CONDUCTIVITY = "W/(m K)"
ELECTRICAL_RESISTANCE, THERMAL_RESISTANCE = "ohm m^2", "K m^2/W"  # times nominal area
# SI unit of each normalised unit.
IN_SI = {
    "lambda_0": METRE,
    "g_0": METRE,
    NORMALISED_PRESSURE: PASCAL,
    "g_0/p_0*": ELECTRICAL_RESISTANCE,  # or THERMAL_RESISTANCE
    "g_0 p_0*": "J m^-2",
    "1/p_0*": "Pa^-1",
    "1/g_0": "m^-1",
    "g_0/lambda_0": NONE,
    "g_0/lambda_0^2": "m^-1",
    "p_0*/lambda_0^(1/2)": "Pa m^-0.5",
}
NORMALISED = tuple(IN_SI)
MAX_LISTED = 10_000  # limit of a range, so that a typing error does not fill the memory
MAX_NAME = 40  # No unit is longer than this.
# Unit names with an optional small power, separated by blanks, signs and brackets; pint would compute 9**9**9**9.
UNIT = re.compile(r"(?:[^\W\d]++(?:\s*(?:\*\*|\^)\s*-?\d|-?\d)?|[\s()*/·%])+")
# Spellings unknown to pint: powers as in "N mm-2" (UDUNITS) and "Ohm" (astropy).
POWER, OHM = re.compile(r"\b([^\W\d_]+)(-?\d)\b"), re.compile(r"Ohm\b")
SIGNS = str.maketrans("\u2212\u2215\u22c5", "-/*")  # signs of minus, division and product
# Errors of pint and of its tokenizer for a text that is no unit or of another quantity.
NO_UNIT = (AssertionError, AttributeError, ArithmeticError, SyntaxError, TokenError, TypeError, ValueError)
# A number, and its unit if it has one. A second number is no unit: a comma is missing.
NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf)(?!\s*[-+.,;\d])\s*(.*?)\s*")


def described(long_name: str, unit: str) -> dict[str, str]:
    """Return the attributes of values in a unit: normalised ones are plain numbers by the CF conventions."""
    if unit not in NORMALISED:
        return {"long_name": long_name, "units": unit}
    return {"long_name": f"{long_name}{in_words(unit)}", "units": NONE, NORMALISED_BY: unit}


def in_words(unit: str) -> str:
    """Return the end of the long name of values in a normalised unit."""
    return f", in {unit}"


def unit_of(values: Any) -> str:
    """Return the unit that a number or an array carries; empty if there is none."""
    attributes = getattr(values, "attrs", None)
    if isinstance(attributes, Mapping):
        named = next((attributes[name] for name in (NORMALISED_BY, "units", "unit") if name in attributes), None)
        if named is not None:
            return str(named)
        values = getattr(values, "data", None)  # xarray may hold an array of pint
    named = getattr(values, "units", getattr(values, "unit", None))
    return "" if named is None else str(named)


def in_unit(name: str, values: Any, unit: str) -> Any:
    """Return plain numbers in `unit`; values without a unit are unchanged, and lists converted element by element."""
    if type(values) in (float, int):
        return values
    if isinstance(values, list | tuple):
        named = [unit_of(value) for value in values]
        foreign = next((given for given in named if given and factor(name, given, unit) != 1), "")
        if foreign and "" in named:
            raise ValueError(f"{name} must all have a unit, as some are in {foreign:.{MAX_NAME}}, or none")
        return [in_unit(name, value, unit) for value in values]
    scale = factor(name, given, unit) if (given := unit_of(values)) else 1
    return bare(values) if scale == 1 else bare(values) * scale


def factor(name: str, given: str, unit: str) -> float:
    """Return the value of the unit `given` in `unit`; ValueError if it is unknown or of another quantity."""
    if given == unit or (given in WITHOUT and (unit in NORMALISED or unit in WITHOUT)):
        return 1.0
    text = unicodedata.normalize("NFKC", given).translate(SIGNS)  # the ohm sign is not the Greek letter
    wanted = "have no unit" if unit == NONE else f"be in {unit}"
    if given in NORMALISED or unit in NORMALISED:
        way = "" if unit == NONE else ": weier.Interface converts from and to SI units"
        raise ValueError(f"{name} must {wanted}, got values in {given:.{MAX_NAME}}{way}")
    try:
        if len(text) > MAX_NAME or not UNIT.fullmatch(text):
            raise ValueError("no unit")
        return float(_registry().Quantity(1.0, text).to("" if unit == NONE else unit).magnitude)
    except NO_UNIT as error:
        raise ValueError(f"{name} must {wanted}, got values in {given:.{MAX_NAME}}") from error


@cache
def _registry() -> pint.UnitRegistry[float]:
    import pint

    return pint.UnitRegistry(preprocessors=[lambda text: POWER.sub(r"\1**\2", OHM.sub("ohm", text))])


def parsed(name: str, value: Any, unit: str) -> Any:
    """Return a number in `unit`, from a number or from a text that may have another unit, as "210 GPa"."""
    if not isinstance(value, str):
        return value
    if (found := NUMBER.fullmatch(value)) is None:
        raise ValueError(f"{name} must be a number, got {value[:MAX_NAME]!r}")
    return float(found[1]) * (factor(name, found[2], unit) if found[2] else 1.0)


def listed(name: str, text: str, unit: str) -> tuple[list[float], str]:
    """Return the numbers of a text such as "1,10 MPa", in `unit`, and their own unit, which follows the last one.

    "1:10:40 MPa" are 40 numbers in equal ratios.
    """
    ranged = ":" in text
    parts = [found for part in text.split(":" if ranged else ",") if (found := NUMBER.fullmatch(part))]
    if len(parts) != (3 if ranged else text.count(",") + 1) or any(part[2] for part in parts[:-1]):
        forms = f'"1,10 {unit}" or "first:last:count {unit}"'
        raise ValueError(f"{name} must read {forms}, got {text!r:.80}: one unit, at the end, is that of all numbers")
    values, own = [float(part[1]) for part in parts], parts[-1][2]
    scale = factor(name, own, unit) if own else 1.0
    if not ranged:
        return [value * scale for value in values], own
    first, last, count = values
    within = 2 <= count <= MAX_LISTED and count == int(count)
    if not (within and min(first, last) > 0 and max(first, last) < math.inf):
        raise ValueError(f"{name} must be 2 to {MAX_LISTED} positive numbers, got {text!r:.80}")
    return np.geomspace(first * scale, last * scale, int(count)).tolist(), own


def bare(values: Any) -> Any:
    """Return the numbers of a quantity without its unit; values without a unit are returned unchanged."""
    if not unit_of(values):
        return values
    for name in ("magnitude", "value"):  # pint; astropy and unyt
        if (found := getattr(values, name, None)) is not None:
            return found
    inner = getattr(values, "data", None)
    return bare(inner) if unit_of(inner) else np.asanyarray(values)
