"""From stiffness to resistance, Eqs (2)-(5), and from normalised results to SI units.

docs/closed_forms.md, "From compliance to resistance", derives the formulas. By (7) and (2) the units are lambda_0,
g_0, p_0* = 2 pi M g_0/lambda_0 and M (rho_1 + rho_2) g_0/p_0* = (rho_1 + rho_2) lambda_0/(2 pi).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import InitVar, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier import units
from weier.checks import Condition, checked_number, checked_numbers, shown
from weier.kernels.arrays import Array
from weier.surface.measured.trace import MAX_SLOPE
from weier.surface.waves import checked_surface

beyond_floats = np.errstate(over="ignore")  # Values larger than the largest float become inf.


@beyond_floats
def composite_modulus(
    *,
    nu_1: ArrayLike,
    nu_2: ArrayLike,
    mu_1: ArrayLike | None = None,
    mu_2: ArrayLike | None = None,
    E_1: ArrayLike | None = None,
    E_2: ArrayLike | None = None,
) -> Array:
    """Return composite modulus M of two bodies, 1/M = (1 - nu_1)/mu_1 + (1 - nu_2)/mu_2 (3).

    Parameters
    ----------
    nu_1, nu_2 : array_like
        Poisson's ratios, in (-1, 0.5].
    mu_1, mu_2 : array_like, optional
        Shear moduli, in Pa or any other unit, which is that of M. One may be inf: a rigid body.
    E_1, E_2 : array_like, optional
        Instead of each of them, Young's modulus E = 2 mu (1 + nu), in the same unit.

    Returns
    -------
    ndarray
        M, of the shape to which the arguments broadcast.

    Raises
    ------
    ValueError
        If a value lies outside its range, both or neither of mu and E are given, or both bodies are rigid.
    """
    moduli = _shear_modulus(1, mu_1, E_1, nu_1), _shear_modulus(2, mu_2, E_2, nu_2)
    softness = (1 - _checked("nu_1", nu_1)) / moduli[0] + (1 - _checked("nu_2", nu_2)) / moduli[1]
    if np.any(softness == 0):
        raise ValueError("mu_1 and mu_2 are both inf: two rigid bodies have no elastic contact, give one a modulus")
    return np.asarray(1 / softness)


def full_contact_pressure(modulus: float, lambda_0: ArrayLike, g_0: ArrayLike) -> Array:
    """Return mean pressure p_0* = 2 pi M g_0/lambda_0 that flattens one wave (7), in the unit of the modulus."""
    return np.asarray(2 * math.pi * modulus * np.asarray(g_0) / np.asarray(lambda_0))


def _shear_modulus(body: int, mu: ArrayLike | None, E: ArrayLike | None, nu: ArrayLike) -> Array:
    """Return the shear modulus of body 1 or 2, which is given itself or by Young's modulus."""
    if mu is not None and E is None:
        return _checked(f"mu_{body}", mu)
    if E is not None and mu is None:
        return np.asarray(_checked(f"E_{body}", E) / (2 * (1 + _checked(f"nu_{body}", nu))))
    given = "neither" if mu is None else "both"
    raise ValueError(f"give one of mu_{body}, the shear modulus, and E_{body}, Young's modulus, got {given}")


@beyond_floats
def specific_resistance(compliance_slope: ArrayLike, modulus: ArrayLike, rho_1: ArrayLike, rho_2: ArrayLike) -> Array:
    """Return resistance times nominal area, R A = M (rho_1 + rho_2) dh/dp, in ohm m^2 (2).

    dh/dp is in m/Pa, M in Pa, the resistivities are in ohm m. Broadcasts.
    """
    slope = checked_numbers("compliance_slope", compliance_slope, unit="m/Pa")
    return np.asarray(_checked("modulus", modulus) * (_checked("rho_1", rho_1) + _checked("rho_2", rho_2)) * slope)


def _sum(rho_1: ArrayLike, rho_2: ArrayLike) -> Array:
    return np.asarray(_checked("rho_1", rho_1) + _checked("rho_2", rho_2))


# condition on each quantity, as words after "must" and as a function, and its unit
RANGES: dict[str, tuple[str, Condition, str]] = {
    **dict.fromkeys(
        ("mu_1", "mu_2", "E_1", "E_2", "modulus"),
        ("be positive (inf for a rigid body)", lambda mu: mu > 0, units.PASCAL),
    ),
    **dict.fromkeys(("nu_1", "nu_2"), ("lie in (-1, 0.5]", lambda nu: (nu > -1) & (nu <= 0.5), units.NONE)),
    **dict.fromkeys(
        ("rho_1", "rho_2"),
        ("be finite and not negative", lambda rho: (rho >= 0) & (rho < math.inf), units.OHM_METRE),
    ),
    **dict.fromkeys(("lambda_0", "g_0"), ("be positive and finite", lambda x: (x > 0) & (x < math.inf), units.METRE)),
}
# ranges outside which a warning names the likely mistake
USUAL = {
    "modulus": (1e6, 1e13, "Pa", "is it in GPa or MPa? Moduli are in Pa"),
    "resistivity": (1e-9, 1e12, "ohm m", "resistivities are in ohm m, and 1 micro-ohm cm is 1e-8 ohm m"),
}
BODIES = ("mu_1", "mu_2", "nu_1", "nu_2", "rho_1", "rho_2")
# The unit in SI of each normalised unit.
SI_UNITS = {
    "lambda_0": units.METRE,
    "g_0": units.METRE,
    "p_0*": units.PASCAL,
    "g_0/p_0*": "ohm m^2",
    "p_0*/lambda_0^(1/2)": "Pa m^-0.5",
}
SLOPE = " dh/dp"  # The end of the long name of a resistance that is normalised.
# The symbol changes where the conversion includes more than a unit, here M and the resistivities.
SI_SYMBOLS = {"R A/(M (rho_1 + rho_2))": "R A"}
# The coordinates of curves that hold the scale of a trace, in m.
OF_TRACE = {"lambda_0": "trace_length", "g_0": "trace_height"}
# The units of the scalars of `weier.fields`, which are attributes.
SCALARS = {"mean_pressure": "p_0*", "mean_gap": "g_0"}
LOADS = "mean_pressure"
OF_DATASETS = "convert the whole Dataset first, as in in_si(curve).resistance"
LOCATED = (LOADS, "x")  # The coordinates with normalised units.
CASE, LOAD = "case", "load"  # Dimensions; cases of different scale have different loads in Pa, over LOAD.


def _checked(name: str, values: ArrayLike) -> Array:
    return checked_numbers(name, values, *RANGES[name])


def _doubts(bodies: Mapping[str, float]) -> Iterator[str]:
    """Yield a warning for each modulus and resistivity that no usual material has, but for 0 and inf."""
    for name, value in bodies.items():
        what = {"mu": "modulus", "E": "modulus", "rho": "resistivity"}.get(name[:-2])
        if what is None or value in (0, math.inf):
            continue
        least, most, unit, slip = USUAL[what]
        if not least <= value <= most:
            limit = f"below {least:g}" if value < least else f"above {most:g}"
            yield f"{name} = {value:g} {unit} is {limit} {unit}: {slip}"


@dataclass(frozen=True, kw_only=True)
class Bodies:
    """Two bodies in contact, which turn normalised results into SI units: see `weier.Interface` for their values."""

    mu_1: float = None  # type: ignore[assignment]  # until E_1 gives it
    mu_2: float = None  # type: ignore[assignment]  # until E_2 gives it
    nu_1: float
    nu_2: float
    rho_1: float
    rho_2: float
    lambda_0: float | None = None
    g_0: float | None = None
    E_1: InitVar[float | None] = None
    E_2: InitVar[float | None] = None

    def __post_init__(self, E_1: float | None, E_2: float | None) -> None:
        moduli = {
            "mu_1": _shear_modulus(1, self.mu_1, E_1, self.nu_1),
            "mu_2": _shear_modulus(2, self.mu_2, E_2, self.nu_2),
        }
        # Scalars of NumPy would overflow, and a float32 would reduce all results to single precision.
        given = {name: value for name, value in (vars(self) | moduli).items() if name in BODIES or value is not None}
        vars(self).update({name: checked_number(name, value, *RANGES[name]) for name, value in given.items()})
        if (self.lambda_0 is None) != (self.g_0 is None):
            missing = "lambda_0" if self.lambda_0 is None else "g_0"
            raise ValueError(f"lambda_0 and g_0 must be given together, or both left out: {missing} is missing")
        known = {name: vars(self)[name] for name in BODIES}
        for body, E in ((1, E_1), (2, E_2)):
            if E is not None:  # A warning names what was given.
                known[f"E_{body}"] = 2 * (1 + known[f"nu_{body}"]) * known.pop(f"mu_{body}")
        for doubt in _doubts(known):
            warnings.warn(doubt, stacklevel=3)  # at the call of Interface
        scale = (1.0, 1.0) if self.lambda_0 is None or self.g_0 is None else (self.lambda_0, self.g_0)
        full = 2 * math.pi * self.composite_modulus * scale[1] / scale[0]  # which refuses two rigid bodies
        if not 0 < full < math.inf:
            raise ValueError(
                "mu_1, mu_2, g_0 and lambda_0 must give a pressure p_0* = 2 pi M g_0/lambda_0 within the range of "
                f"floats, got {full}"
            )
        slope = math.sqrt(2) * math.pi * scale[1] / scale[0]
        if self.g_0 is not None and slope > MAX_SLOPE:
            raise ValueError(
                f"g_0 must give the coarsest wave a root mean square slope of at most {MAX_SLOPE:g}, got {slope:.3g} "
                f"from g_0 = {self.g_0:g} m over lambda_0 = {self.lambda_0:g} m: is a unit wrong?"
            )

    @property
    def composite_modulus(self) -> float:
        """Composite modulus M, in Pa (3)."""
        return float(composite_modulus(mu_1=self.mu_1, nu_1=self.nu_1, mu_2=self.mu_2, nu_2=self.nu_2))

    @property
    def full_contact_pressure(self) -> float:
        """p_0* = 2 pi M g_0/lambda_0, in Pa (7): the unit of normalised pressures."""
        return float(self._scales()["p_0*"][0])

    def at(self, surface: Any) -> Bodies:
        """Return both bodies with lambda_0 and g_0 of a trace, or with those given here for a series.

        Parameters
        ----------
        surface : Profile, Trace or Dataset
            The surface, or one curve of it.

        Raises
        ------
        ValueError
            If the surface is a series, and this interface has no lambda_0 and g_0.
        """
        if hasattr(surface, "data_vars"):
            lambda_0, g_0 = self._scale_of(surface)
            if _varies((lambda_0, g_0)):
                raise ValueError("surface must be one, got curves of traces of several lengths or heights")
        elif hasattr(checked_surface(surface, "surface"), "g_0"):
            lambda_0, g_0 = np.asarray(surface.lambda_0), np.asarray(surface.g_0)
        else:
            lambda_0, g_0 = map(np.asarray, self._scale())
        with warnings.catch_warnings():  # which were given when this interface was made
            warnings.simplefilter("ignore")
            return replace(self, lambda_0=float(lambda_0), g_0=float(g_0))

    def pressure(self, normalised: ArrayLike) -> Array:
        """Convert pressures from p_0* to Pa."""
        return self._of_unit("p_0*", normalised)

    def normalised_pressure(self, pressure: ArrayLike) -> Array:
        """Convert pressures of any shape from Pa to p_0*, as `weier.solve` takes them."""
        return np.asarray(checked_numbers("pressure", pressure, unit=units.PASCAL) / self.full_contact_pressure)

    def compliance(self, normalised: ArrayLike) -> Array:
        """Convert compliances, heights and gaps from g_0 to m."""
        return self._of_unit("g_0", normalised)

    def resistance(self, normalised: ArrayLike) -> Array:
        """Convert specific contact resistances from g_0/p_0* to ohm m^2 (2)."""
        return self._of_unit("g_0/p_0*", normalised)

    def in_si(self, data: Any) -> Any:
        """Convert a Dataset with its coordinates to SI units; call it before any arithmetic.

        Parameters
        ----------
        data : Dataset
            Results of weier, such as a curve of `weier.solve`: the attribute `normalised_by` is the unit of a
            variable. Curves of traces are converted by the length and height of each trace, others by lambda_0 and
            g_0 of this interface.

        Returns
        -------
        Dataset
            The same with `units` such as "Pa", and with this interface among its attributes. What has another unit
            stays as it is, and so does NaN, where a value is missing. Where traces of several lengths or heights have
            common normalised loads, the loads in Pa depend on the case, and the dimension mean_pressure becomes
            `load`.

        Raises
        ------
        ValueError
            If this is no data of weier, is in SI units already, or has lost a unit.

        Examples
        --------
        >>> import weier
        >>> bodies = {"mu_1": 45e9, "mu_2": 45e9, "nu_1": 0.34, "nu_2": 0.34, "rho_1": 1.7e-8, "rho_2": 1.7e-8}
        >>> contact = weier.Interface(**bodies, lambda_0=1e-3, g_0=1e-6)
        >>> curve = contact.in_si(weier.solve(weier.Profile(D=1.5, gamma=3, m=2), [0.1, 1.0], "demelio"))
        >>> print(f"{curve.mean_pressure.values[0]:.3e}", curve.mean_pressure.units, curve.resistance.units)
        2.142e+07 Pa ohm m^2
        """
        if not hasattr(data, "data_vars"):
            raise ValueError(f"data must be a Dataset of weier, got {shown(data)}: {OF_DATASETS}")
        _check_normalised(data)
        scale = self._scale_of(data)
        own_loads = LOADS in data.dims and units.unit_of(data[LOADS]) in units.NORMALISED
        # mean_pressure becomes a coordinate without index.
        found = data.reset_index(LOADS).rename_dims({LOADS: LOAD}) if _varies(scale) and own_loads else data
        known = self._scales(*scale)
        # By methods of the dataset itself, so that nothing of xarray has to be imported here.
        values = {name: _converted(variable, known) for name, variable in found.variables.items()}
        coordinates = list(found.coords)
        found = found.assign(values).set_coords(coordinates)
        own = {name: value for name, value in vars(self).items() if value is not None}
        if not _varies(scale):
            own |= {name: float(value) for name, value in zip(OF_TRACE, scale, strict=True)}
        found = found.assign_attrs(own)
        if "normalisation" in found.attrs:
            for name in SCALARS.keys() & found.attrs.keys():
                found.attrs[name] = found.attrs[name] * float(known[SCALARS[name]][0])
            del found.attrs["normalisation"]
        return found

    def _scale_of(self, data: Any) -> tuple[Array, Array]:
        """Return lambda_0 and g_0 of the curves, one or one per case: of their traces, else of this interface."""
        own = [np.asarray(data.coords.get(name, math.nan), float) for name in OF_TRACE.values()]
        if not np.isfinite(own).all():
            own = [
                np.where(np.isfinite(values), values, of_series)
                for values, of_series in zip(own, self._scale(), strict=True)
            ]
        lambda_0, g_0 = own if _varies(own) else [values.flat[0] for values in own]
        return lambda_0, g_0

    def _scale(self) -> tuple[float, float]:
        if self.lambda_0 is None or self.g_0 is None:
            raise ValueError(
                "lambda_0 and g_0 must be given for a series, in m: weier.Interface(..., lambda_0=1e-3, g_0=1e-6)"
            )
        return self.lambda_0, self.g_0

    @property
    def scales(self) -> dict[str, tuple[Array, str]]:
        """The value of each normalised unit in SI units, and their names."""
        return self._scales()

    def _scales(
        self, lambda_0: ArrayLike | None = None, g_0: ArrayLike | None = None
    ) -> dict[str, tuple[Array, str]]:
        """Return the value of each normalised unit in SI units, at the given scale or that of these bodies."""
        scale = self._scale() if lambda_0 is None or g_0 is None else (lambda_0, g_0)
        length, height = (np.asarray(value, float) for value in scale)
        p = full_contact_pressure(self.composite_modulus, length, height)
        slope = specific_resistance(height / p, self.composite_modulus, self.rho_1, self.rho_2)
        values = {"lambda_0": length, "g_0": height, "p_0*": p, "g_0/p_0*": slope}
        values["p_0*/lambda_0^(1/2)"] = p / np.sqrt(length)
        return {name: (value, SI_UNITS[name]) for name, value in values.items()}

    def _of_unit(self, unit: str, normalised: Any) -> Array:
        """Return values of one unit; those that say they are of another one are refused."""
        numbers = checked_numbers("normalised", normalised, unit=unit)
        if hasattr(normalised, "to_dataset"):  # which may be of a trace, with a scale of its own
            raise ValueError(f"normalised must be numbers, got a DataArray: {OF_DATASETS}")
        return _scaled(numbers, self._scales()[unit][0])


def to_normalised(bodies: Bodies, name: str, unit: str, values: ArrayLike) -> Array:
    """Convert values of a quantity from SI to normalised units.

    Raises
    ------
    ValueError
        If these are resistances between two perfect conductors, which have none.
    """
    factor, si = bodies.scales.get(unit, (np.array(1.0), units.NONE))
    if factor == 0:
        raise ValueError("resistance must be between bodies with a resistivity, got two perfect conductors")
    return np.asarray(checked_numbers(name, values, unit=si) / factor)


def _is_computed(variable: Any) -> bool:
    """Return whether arithmetic dropped attributes of a variable of weier, whose operands differ in `long_name`."""
    return variable.attrs.get("units") == units.NONE and "long_name" not in variable.attrs


def _check_normalised(data: Any) -> None:
    """Refuse a Dataset with a variable whose unit is unknown, or that is in SI units already."""
    described = dict[str, str]()
    for name, variable in data.variables.items():
        if name not in data.data_vars and name not in LOCATED:
            continue
        if variable.dtype.kind == "f" and (not units.unit_of(variable) or _is_computed(variable)):
            raise ValueError(
                f"{name} has lost its unit, as by a mean or a ratio: give it again by "
                f'data["{name}"].attrs = {{"normalised_by": "g_0"}}, or "1" for a plain number'
            )
        if units.unit_of(variable) in units.NORMALISED and "long_name" in variable.attrs:
            other = described.setdefault(str(variable.attrs["long_name"]), str(name))
            if other != name and not variable.equals(data.variables[other]):  # A copy has the same unit.
                raise ValueError(
                    f"{name} must have attributes of its own, got those of {other}, which arithmetic may have kept: "
                    f'set data["{name}"].attrs = {{"normalised_by": "1"}} for a ratio, or its unit instead of "1"'
                )
    if not any(units.unit_of(variable) in units.NORMALISED for variable in data.variables.values()):
        raise ValueError("data must be normalised, got no quantity in units such as p_0*: is it in SI units already?")
    if known := {*BODIES} & data.attrs.keys():
        raise ValueError(
            f"data must be normalised, got a Dataset with {min(known)}, which an interface has converted"
        )


def _varies(scale: Iterable[Array]) -> bool:
    """Return whether cases differ in scale."""
    return any(np.ptp(values) > 0 for values in scale)


def _converted(variable: Any, known: Mapping[str, tuple[Array, str]]) -> tuple[Any, Any, dict[str, Any]]:
    """Return dimensions, values and attributes of a variable, in SI units where it has a normalised unit."""
    attributes = dict(variable.attrs)
    unit = attributes.pop(units.NORMALISED_BY, None)
    if unit not in known:
        return variable.dims, variable.values, dict(variable.attrs)
    factor, attributes["units"] = known[unit]
    if "long_name" in attributes:
        attributes["long_name"] = str(attributes["long_name"]).removesuffix(units.in_words(unit)).removesuffix(SLOPE)
    if "symbol" in attributes:
        attributes["symbol"] = SI_SYMBOLS.get(attributes["symbol"], attributes["symbol"])
    dims, values = variable.dims, variable.values
    if factor.ndim:
        dims = (CASE, *(dim for dim in dims if dim != CASE))
        values = np.moveaxis(values, variable.dims.index(CASE), 0) if CASE in variable.dims else values[None]
        factor = factor.reshape(-1, *(1 for _ in dims[1:]))
    for name in ("valid_min", "valid_max"):
        if name in attributes:
            attributes[name] = float(attributes[name] * factor.max())
    return dims, _scaled(values, factor), attributes


@np.errstate(over="ignore", invalid="ignore")
def _scaled(values: Array, unit: Array) -> Array:
    """Return values in a unit; NaN, where a value is missing, stays NaN.

    An infinite resistance is that of no contact, and stays infinite for perfect conductors, too, whose unit is 0.
    """
    return np.where(np.isfinite(values), np.asarray(values, float) * unit, values)
