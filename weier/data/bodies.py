"""Two bodies in contact, which convert normalised results to SI units and pressures back.

By (7) and (2) the units are lambda_0, g_0, p_0* = 2 pi M g_0/lambda_0 and M (rho_1 + rho_2) g_0/p_0* =
(rho_1 + rho_2) lambda_0/(2 pi). For heat, 1/k replaces rho.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import InitVar, dataclass, replace
from inspect import signature
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

from weier import units
from weier.checks import checked_number, checked_numbers
from weier.data.curves import contact_pressure
from weier.data.markdown import significant
from weier.data.si import CONVERT_DATASET, check_normalised, converted, scaled
from weier.data.variables import LOADS
from weier.kernels.arrays import Array
from weier.surface.measured.trace import MIN_STEP, USUAL_LENGTH
from weier.surface.waves import checked_surface
from weier.theory.conduction import (
    RANGES,
    composite_modulus,
    full_contact_pressure,
    shear_modulus,
    specific_resistance,
)

if TYPE_CHECKING:
    import xarray as xr

CURRENT, HEAT = ("rho_1", "rho_2"), ("k_1", "k_2")
CONDUCTORS = "give rho_1 and rho_2, the resistivities, or k_1 and k_2, the thermal conductivities"
# Ranges outside which a warning asks for the unit. Steeper coarsest waves have a p_0* above the shear modulus.
USUAL = {"mu": (1e6, 1e13), "rho": (1e-8, 1e-3), "k": (0.01, 1e4), "hardness": (1e6, 2e11)}
USUAL |= {"lambda": (2 * MIN_STEP, USUAL_LENGTH), "g_0/lambda_0": (1e-8, 0.2)}
# Mean pressure of a line contact at first yield over the hardness, 1.4 Y/3 Y (Johnson 1985, Sections 6.1 and 6.3).
YIELD = 0.47
# The coordinates of curves that hold the scale of a trace, in m.
TRACE_SCALE = {"lambda_0": "trace_length", "g_0": "trace_height"}


@dataclass(frozen=True, kw_only=True)
class Bodies:
    """Two bodies in contact, which turn normalised results into SI units: see `weier.Interface` for their values."""

    mu_1: float = None  # type: ignore[assignment]  # until E_1 gives it
    mu_2: float = None  # type: ignore[assignment]  # until E_2 gives it
    nu_1: float
    nu_2: float
    rho_1: float | None = None
    rho_2: float | None = None
    k_1: float | None = None
    k_2: float | None = None
    lambda_0: float | None = None
    g_0: float | None = None
    hardness_1: float | None = None
    hardness_2: float | None = None
    E_1: InitVar[float | None] = None
    E_2: InitVar[float | None] = None

    @classmethod
    def from_texts(cls, given: Mapping[str, Any]) -> Self:
        """Return the bodies of a file, whose values may have units, as in "210 GPa"."""
        try:
            read = {name: units.parsed(name, given[name], RANGES[name][2]) for name in RANGES.keys() & given.keys()}
            return cls(**{**given, **read})
        except TypeError as error:  # a name is missing or unknown
            names = ", ".join(signature(cls).parameters)
            raise ValueError(f"{str(error).partition(' ')[2]}: two bodies have {names}") from None

    def __post_init__(self, E_1: float | None, E_2: float | None) -> None:
        moduli = {
            "mu_1": shear_modulus(1, self.mu_1, E_1, self.nu_1),
            "mu_2": shear_modulus(2, self.mu_2, E_2, self.nu_2),
        }
        # Scalars of NumPy would overflow, and a float32 would reduce all results to single precision.
        given = {name: value for name, value in (vars(self) | moduli).items() if value is not None}
        if (conducting := given.keys() & {*CURRENT, *HEAT}) not in (set(CURRENT), set(HEAT)):
            raise ValueError(f"{CONDUCTORS}, got {', '.join(sorted(conducting)) or 'none'}")
        vars(self).update({name: checked_number(name, value, *RANGES[name]) for name, value in given.items()})
        if (self.lambda_0 is None) != (self.g_0 is None):
            missing = "lambda_0" if self.lambda_0 is None else "g_0"
            raise ValueError(f"lambda_0 and g_0 must be given together, or both left out: {missing} is missing")
        known = self.given | {"modulus": self.composite_modulus}  # raises for two rigid bodies
        if self.lambda_0 is not None and self.g_0 is not None:
            known["g_0/lambda_0"] = self.g_0 / self.lambda_0
        for name, value in known.items():
            usual = USUAL.get(name) or USUAL.get(name[:-2], (-math.inf, math.inf))
            if value not in (0, math.inf) and not usual[0] <= value <= usual[1]:
                unit = RANGES[name][2] if name in RANGES else "m/m"
                limits = f"from {usual[0]:g} to {usual[1]:g} {unit}"
                # points to the call of Interface
                warnings.warn(f"{name} = {value:g} {unit} is not {limits}: is the unit right?", stacklevel=3)

    @property
    def given(self) -> dict[str, float]:
        """The values of both bodies without those that are left out."""
        return {name: value for name, value in vars(self).items() if value is not None}

    @property
    def composite_modulus(self) -> float:
        """Composite modulus M, in Pa (3)."""
        return float(composite_modulus(mu_1=self.mu_1, nu_1=self.nu_1, mu_2=self.mu_2, nu_2=self.nu_2))

    @property
    def resistivities(self) -> tuple[float, float]:
        """The resistivities of both bodies, in ohm m, or the inverses of the thermal conductivities."""
        given = self.given
        return (given["rho_1"], given["rho_2"]) if self.k_1 is None else (1 / given["k_1"], 1 / given["k_2"])

    @property
    def resistance_unit(self) -> str:
        """The unit of resistance times nominal area, ohm m^2, or K m^2/W for heat."""
        return units.ELECTRICAL_RESISTANCE if self.k_1 is None else units.THERMAL_RESISTANCE

    @property
    def full_contact_pressure(self) -> float:
        """p_0* = 2 pi M g_0/lambda_0, in Pa (7): the unit of normalised pressures."""
        return float(self.scales()["p_0*"][0])

    def at(self, surface: Any) -> Bodies:
        """Return both bodies with lambda_0 and g_0 of a Trace, or with those given here for a Profile."""
        has_own = hasattr(checked_surface(surface, "surface"), "g_0")
        lambda_0, g_0 = (surface.lambda_0, surface.g_0) if has_own else self._scale()
        with warnings.catch_warnings(action="ignore"):  # the constructor has already given them
            return replace(self, lambda_0=float(lambda_0), g_0=float(g_0))

    def pressure(self, normalised: ArrayLike) -> Array:
        """Convert pressures from p_0* to Pa."""
        return self._to_si("p_0*", normalised)

    def normalised_pressure(self, pressure: ArrayLike) -> Array:
        """Convert pressures of any shape from Pa to p_0*, as `weier.solve` takes them."""
        return np.asarray(checked_numbers("pressure", pressure, unit=units.PASCAL) / self.full_contact_pressure)

    def compliance(self, normalised: ArrayLike) -> Array:
        """Convert compliances, heights and gaps from g_0 to m."""
        return self._to_si("g_0", normalised)

    def resistance(self, normalised: ArrayLike) -> Array:
        """Convert specific contact resistances from g_0/p_0* to ohm m^2 (2), or to K m^2/W for heat."""
        return self._to_si("g_0/p_0*", normalised)

    def in_si(self, data: xr.Dataset) -> xr.Dataset:
        """Convert a Dataset with its coordinates to SI units; call it before any arithmetic.

        Parameters
        ----------
        data : Dataset
            Results of weier, such as a curve of `weier.solve`: the attribute `normalised_by` is the unit of a
            variable. Curves of traces are converted by the length and height of each trace, which are coordinates,
            those of series, with a coordinate D, by lambda_0 and g_0 of this interface.

        Returns
        -------
        Dataset
            The same with `units` such as "Pa", and with this interface among its attributes. What has another unit
            stays as it is, and so does NaN, where a value is missing.

        Raises
        ------
        ValueError
            If this is no data of weier, is in SI units already, has lost a unit or its coordinates, or comes from
            arithmetic, which keeps attributes: xarray's selections and joins are accepted, and anything from a file.
            If traces of several lengths or heights have common loads in p_0*, which are different ones in Pa.

        Examples
        --------
        >>> import weier
        >>> bodies = {"mu_1": 45e9, "mu_2": 45e9, "nu_1": 0.34, "nu_2": 0.34, "rho_1": 1.7e-8, "rho_2": 1.7e-8}
        >>> contact = weier.Interface(**bodies, lambda_0=1e-3, g_0=1e-6)
        >>> curve = contact.in_si(weier.solve(weier.Profile(D=1.5, gamma=3, m=2), [0.1, 1.0], "demelio"))
        >>> print(f"{curve.mean_pressure.values[0]:.3e}", curve.mean_pressure.units, curve.resistance.units)
        2.142e+07 Pa ohm m^2
        """
        check_normalised(data)
        scales, own = self.scales(data), self.given
        if not scales["g_0"][0].ndim:
            own |= {name: float(scales[name][0]) for name in TRACE_SCALE}
        found = converted(data, scales).assign_attrs(own)
        self.warn_of_yield(found)
        return found

    def warn_of_yield(self, curves: xr.Dataset) -> None:
        """Warn once of loads, in Pa, at which contacts yield, and of loads without a contact area to judge this."""
        hardness = min(filter(None, (self.hardness_1, self.hardness_2)), default=math.inf)
        solved = curves.get("compliance", curves.get("contact_fraction"))
        if math.isinf(hardness) or solved is None or LOADS not in curves.coords:
            return
        area = curves.get("contact_fraction", solved * math.nan)
        pressure = curves[LOADS]
        of_contacts = contact_pressure(pressure, area)
        others = [dim for dim in area.dims if dim not in pressure.dims]
        if (unknown := (solved.notnull() & area.isnull()).any(others)).any():
            warnings.warn(
                f"whether contacts yield cannot be judged at {unknown.sum().item()} of {unknown.size} loads, which "
                "have no contact fraction: some methods return none, nor does one that leaves terms out",
                stacklevel=3,  # points to the call of the conversion
            )
        if (near := (of_contacts > YIELD * hardness).any(others)).any():
            pressures = pressure.where(near).min().item(), hardness, of_contacts.max().item()
            first, limit, largest = (f"{significant(one / 1e6, 3)} MPa" for one in pressures)
            count = near.sum().item()
            warnings.warn(
                f"contacts yield from a mean pressure of {first} on, at {count} of {near.size} loads: p over "
                f"the contact fraction exceeds {YIELD} of the lower hardness, {limit}, and reaches {largest}. "
                "Elastic contact underestimates their area: take lighter loads, or judge these results as elastic",
                stacklevel=3,  # points to the call of the conversion
            )

    def _scale_of(self, curves: xr.Dataset) -> tuple[Array, Array]:
        """Return lambda_0 and g_0 of curves, or per case: a trace has its own."""
        known = (np.asarray(curves.variables.get(name, math.nan), float) for name in ("D", *TRACE_SCALE.values()))
        D, length, height = np.broadcast_arrays(*known)
        is_trace = np.isfinite(length) & np.isfinite(height)
        if (np.isnan(D) & ~is_trace).any():
            raise ValueError(
                "data must have the coordinate D of a series, or trace_length and trace_height of a trace, which "
                "give its units: convert the whole curve before coordinates are dropped"
            )
        if not is_trace.all():
            lambda_0, g_0 = self._scale()
            length, height = np.where(is_trace, length, lambda_0), np.where(is_trace, height, g_0)
        # one scale if the cases do not differ
        return (length, height) if np.ptp(length) or np.ptp(height) else (length.ravel()[0], height.ravel()[0])

    def _scale(self) -> tuple[Array, Array]:
        if self.lambda_0 is None or self.g_0 is None:
            raise ValueError(
                "lambda_0 and g_0 must be given for a series, in m: weier.Interface(..., lambda_0=1e-3, g_0=1e-6)"
            )
        return np.asarray(self.lambda_0), np.asarray(self.g_0)

    def scales(self, curves: xr.Dataset | None = None) -> dict[str, tuple[Array, str]]:
        """Return the value and the SI name of each normalised unit; one value per case for curves of several traces.

        Without curves, lambda_0 and g_0 are those given here.
        """
        lambda_0, g_0 = self._scale() if curves is None else self._scale_of(curves)
        p = full_contact_pressure(self.composite_modulus, lambda_0, g_0)
        slope = specific_resistance(g_0 / p, self.composite_modulus, *self.resistivities)
        values = {"lambda_0": lambda_0, "g_0": g_0, "p_0*": p, "g_0/p_0*": slope}
        values |= {"g_0 p_0*": g_0 * p, "g_0/lambda_0": g_0 / lambda_0, "g_0/lambda_0^2": g_0 / lambda_0**2}
        values |= {"p_0*/lambda_0^(1/2)": p / np.sqrt(lambda_0), "1/p_0*": 1 / p, "1/g_0": 1 / g_0}
        of_resistance = {"g_0/p_0*": self.resistance_unit}
        return {name: (value, (units.IN_SI | of_resistance)[name]) for name, value in values.items()}

    def _to_si(self, unit: str, normalised: Any) -> Array:
        """Convert values in a normalised unit to SI; refuse values that state another unit."""
        numbers = checked_numbers("normalised", normalised, unit=unit)
        if hasattr(normalised, "to_dataset"):  # a curve of a trace has a scale of its own
            raise ValueError(f"normalised must be numbers, got a DataArray: {CONVERT_DATASET}")
        return scaled(numbers, self.scales()[unit][0])


def to_normalised(bodies: Bodies, name: str, unit: str, values: ArrayLike) -> Array:
    """Convert values of a quantity from SI to normalised units; ValueError for a resistance that is always 0."""
    factor, si = bodies.scales().get(unit, (np.array(1.0), units.NONE))
    if factor == 0:
        raise ValueError("resistance must be between bodies with a resistivity, got two perfect conductors")
    return np.asarray(checked_numbers(name, values, unit=si) / factor)
