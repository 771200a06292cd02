"""From stiffness to resistance, Eqs (2)-(5), and from normalised results to SI units.

The formulas are those of docs/closed_forms.md, "From compliance to resistance". The scales of an `Interface` follow
from (7): lengths in lambda_0, heights in g_0, pressures in p_0* = 2 pi M g_0/lambda_0, and by (2) resistances times
area in M (rho_1 + rho_2) g_0/p_0* = (rho_1 + rho_2) lambda_0/(2 pi).
"""

from __future__ import annotations

import math
from dataclasses import InitVar, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import Condition, checked_number, checked_numbers, shown
from weier.kernels.arrays import Array
from weier.tables import html_table

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
    """Composite modulus M of two bodies, 1/M = (1 - nu_1)/mu_1 + (1 - nu_2)/mu_2 (3).

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


def _shear_modulus(body: int, mu: ArrayLike | None, E: ArrayLike | None, nu: ArrayLike) -> Array:
    """The shear modulus of body 1 or 2, which is given itself or by Young's modulus."""
    if mu is not None and E is None:
        return _checked(f"mu_{body}", mu)
    if E is not None and mu is None:
        return np.asarray(_checked(f"E_{body}", E) / (2 * (1 + _checked(f"nu_{body}", nu))))
    given = "neither" if mu is None else "both"
    raise ValueError(f"give one of mu_{body}, the shear modulus, and E_{body}, Young's modulus, got {given}")


@beyond_floats
def specific_resistance(compliance_slope: ArrayLike, modulus: ArrayLike, rho_1: ArrayLike, rho_2: ArrayLike) -> Array:
    """Resistance times nominal area, R A = M (rho_1 + rho_2) dh/dp, in ohm m^2 (2).

    dh/dp is in m/Pa, M in Pa, the resistivities are in ohm m. Broadcasts.
    """
    slope = checked_numbers("compliance_slope", compliance_slope)
    return np.asarray(_checked("modulus", modulus) * _sum(rho_1, rho_2) * slope)


@beyond_floats
def holm(radii: ArrayLike, rho_1: ArrayLike, rho_2: ArrayLike) -> Array:
    """Resistance of circular contacts far apart, in ohm (4).

    Parameters
    ----------
    radii : array_like, shape (..., contacts)
        Radii a_i, in m.
    rho_1, rho_2 : array_like, shape (...)
        Resistivities, in ohm m.

    Notes
    -----
    (4) prints (rho_1 + rho_2)/(2 sum a_i). A circular contact has the stiffness dF/dh = 4 M a and so, by (2),
    the resistance (rho_1 + rho_2)/(4 a), which is Holm's rho/(2 a) for two bodies of one metal.
    """
    radii = _checked("radii", radii)
    if radii.ndim == 0 or radii.shape[-1] == 0:
        raise ValueError(f"radii must be those of at least one contact, as a list, got {shown(radii)}")
    return np.asarray(_sum(rho_1, rho_2) / (4 * np.sum(radii, axis=-1)))


@beyond_floats
def greenwood(radii: ArrayLike, contour_radius: ArrayLike, rho_1: ArrayLike, rho_2: ArrayLike) -> Array:
    """Resistance of circular contacts clustered in a circle of radius `contour_radius`, in ohm (5).

    `radii` has shape (..., contacts) and is in m; the other arguments have shape (...). As for `holm`, half of
    what (5) prints.
    """
    contour = _sum(rho_1, rho_2) / (4 * _checked("contour_radius", contour_radius))
    return np.asarray(holm(radii, rho_1, rho_2) + contour)


def _sum(rho_1: ArrayLike, rho_2: ArrayLike) -> Array:
    return np.asarray(_checked("rho_1", rho_1) + _checked("rho_2", rho_2))


# The condition on each quantity, in words that follow "must" and as a function.
RANGES: dict[str, tuple[str, Condition]] = {
    **dict.fromkeys(
        ("mu_1", "mu_2", "E_1", "E_2", "modulus"), ("be positive (inf for a rigid body)", lambda mu: mu > 0)
    ),
    **dict.fromkeys(("nu_1", "nu_2"), ("lie in (-1, 0.5]", lambda nu: (nu > -1) & (nu <= 0.5))),
    **dict.fromkeys(("rho_1", "rho_2"), ("be finite and not negative", lambda rho: (rho >= 0) & (rho < math.inf))),
    **dict.fromkeys(("lambda_0", "g_0"), ("be positive and finite", lambda x: (x > 0) & (x < math.inf))),
    **dict.fromkeys(("radii", "contour_radius"), ("be positive", lambda radius: radius > 0)),
}
# The symbol changes where the conversion includes more than a unit, here M and the resistivities.
SI_SYMBOLS = {"R A/(M (rho_1 + rho_2))": "R A"}
SCALE_TOLERANCE = 1e-6  # Lengths that differ by less, relative, are the same: people copy six or seven digits.
# The coordinates of curves that hold the scale of a trace, in m.
OF_TRACE = {"lambda_0": "trace_length", "g_0": "trace_height"}
# The units of the scalars of `weier.fields`, which are attributes.
SCALARS = {"mean_pressure": "p_0*", "mean_gap": "g_0"}


def _checked(name: str, values: ArrayLike) -> Array:
    return checked_numbers(name, values, *RANGES[name])


@dataclass(frozen=True, kw_only=True)
class Interface:
    """Two bodies and the scale of their roughness: turns normalised results into SI units.

    Parameters
    ----------
    mu_1, mu_2 : float
        Shear moduli, in Pa. One may be inf: a rigid body.
    E_1, E_2 : float
        Instead of each of them, Young's modulus E = 2 mu (1 + nu), in Pa, which the interface turns into mu.
    nu_1, nu_2 : float
        Poisson's ratios, in (-1, 0.5].
    rho_1, rho_2 : float
        Resistivities, in ohm m. 0 is a perfect conductor.
    lambda_0, g_0 : float
        Wavelength and amplitude of the coarsest wave, in m; for a `Trace`, its own lambda_0 and g_0.

    Raises
    ------
    ValueError
        If a value lies outside its range, both or neither of mu and E are given, or both bodies are rigid.

    Examples
    --------
    >>> import weier
    >>> copper = {"mu_1": 45e9, "mu_2": 45e9, "nu_1": 0.34, "nu_2": 0.34, "rho_1": 1.7e-8, "rho_2": 1.7e-8}
    >>> contact = weier.Interface(**copper, lambda_0=1e-3, g_0=1e-6)
    >>> print(f"{contact.pressure(0.1) / 1e6:.1f} MPa, {contact.resistance(2.5):.2e} ohm m2")
    21.4 MPa, 1.35e-11 ohm m2

    """

    mu_1: float = None  # type: ignore[assignment]  # until E_1 gives it
    mu_2: float = None  # type: ignore[assignment]
    nu_1: float
    nu_2: float
    rho_1: float
    rho_2: float
    lambda_0: float
    g_0: float
    E_1: InitVar[float | None] = None
    E_2: InitVar[float | None] = None

    def __post_init__(self, E_1: float | None, E_2: float | None) -> None:
        moduli = {
            "mu_1": _shear_modulus(1, self.mu_1, E_1, self.nu_1),
            "mu_2": _shear_modulus(2, self.mu_2, E_2, self.nu_2),
        }
        vars(self).update(moduli)
        # Scalars of NumPy would overflow, and a float32 would reduce all results to single precision.
        vars(self).update({name: checked_number(name, value, *RANGES[name]) for name, value in vars(self).items()})
        if not 0 < self.full_contact_pressure < math.inf:  # which refuses two rigid bodies
            raise ValueError(
                "mu_1, mu_2, g_0 and lambda_0 must give a pressure p_0* = 2 pi M g_0/lambda_0 within the range of "
                f"floats, got {self.full_contact_pressure}"
            )

    def _repr_html_(self) -> str:
        """A table of both bodies, for notebooks."""
        rows = [
            [str(body), *(f"{vars(self)[f'{name}_{body}']:.6g}" for name in ("mu", "nu", "rho"))] for body in (1, 2)
        ]
        scale = f"lambda_0 = {self.lambda_0:.6g} m, g_0 = {self.g_0:.6g} m, M = {self.composite_modulus:.6g} Pa"
        header = ["body", "shear modulus mu, Pa", "Poisson's ratio nu", "resistivity rho, ohm m"]
        return html_table(scale, header, rows, f"p_0* = {self.full_contact_pressure:.6g} Pa")

    @property
    def composite_modulus(self) -> float:
        """Composite modulus M, in Pa (3)."""
        return float(composite_modulus(mu_1=self.mu_1, nu_1=self.nu_1, mu_2=self.mu_2, nu_2=self.nu_2))

    @property
    def full_contact_pressure(self) -> float:
        """p_0* = 2 pi M g_0/lambda_0, in Pa (7): the unit of normalised pressures."""
        return 2 * math.pi * self.composite_modulus * self.g_0 / self.lambda_0

    def pressure(self, normalised: ArrayLike) -> Any:
        """Pressures in Pa, from pressures in p_0*: a DataArray where one is given, else an array."""
        return self._of_unit("p_0*", normalised)

    def normalised_pressure(self, pressure: ArrayLike) -> Array:
        """Pressures in p_0*, which `weier.solve` takes, from pressures in Pa, of any shape."""
        return np.asarray(checked_numbers("pressure", pressure) / self.full_contact_pressure)

    def compliance(self, normalised: ArrayLike) -> Any:
        """Compliances, heights and gaps in m, from those in g_0, likewise."""
        return self._of_unit("g_0", normalised)

    def resistance(self, normalised: ArrayLike) -> Any:
        """Specific contact resistances in ohm m^2, from those in g_0/p_0*, likewise (2)."""
        return self._of_unit("g_0/p_0*", normalised)

    def in_si(self, data: Any) -> Any:
        """All of a Dataset or DataArray in SI units, coordinates too.

        Parameters
        ----------
        data : Dataset or DataArray
            Of weier, such as a curve of `weier.solve`: the attribute `unit` says what a variable is in.

        Returns
        -------
        Dataset or DataArray
            The same with `units` such as "Pa", and with this interface among the attributes of a Dataset. What has no
            unit stays as it is, and so does NaN, where a value is missing.

        Raises
        ------
        ValueError
            If this is no data of weier, or a curve of a trace whose lambda_0 and g_0 are others.

        Examples
        --------
        >>> import weier
        >>> bodies = {"mu_1": 45e9, "mu_2": 45e9, "nu_1": 0.34, "nu_2": 0.34, "rho_1": 1.7e-8, "rho_2": 1.7e-8}
        >>> contact = weier.Interface(**bodies, lambda_0=1e-3, g_0=1e-6)
        >>> curve = contact.in_si(weier.solve(weier.Profile(D=1.5, gamma=3, m=2), [0.1, 1.0], "demelio"))
        >>> print(f"{curve.mean_pressure.values[0]:.3e}", curve.mean_pressure.units, curve.resistance.units)
        2.142e+07 Pa ohm m^2
        """
        if hasattr(data, "data_vars"):
            self._check_scale(data)
            # By methods of the dataset itself, so that nothing of xarray has to be imported here.
            values = {name: self._converted(variable) for name, variable in data.variables.items()}
            found = data.assign(values).assign_attrs(vars(self))
            for name in SCALARS.keys() & found.attrs.keys():
                found.attrs[name] = found.attrs[name] * self._units[SCALARS[name]][0]
            found.attrs.pop("normalisation", None)
            return found
        if hasattr(data, "to_dataset"):
            return self.in_si(data.to_dataset(name="_"))["_"].rename(data.name)
        raise ValueError(f"data must be a Dataset or a DataArray of weier, got {shown(data)}")

    def _check_scale(self, data: Any) -> None:
        """Refuse curves of traces in units of another length or height than their own."""
        for name, of_trace in OF_TRACE.items():
            known = np.asarray(data.coords.get(of_trace, math.nan), float)
            strange = known[np.abs(known / getattr(self, name) - 1) > SCALE_TOLERANCE]
            if strange.size:
                raise ValueError(
                    f"{name} must be that of the trace, {strange[0]:.9g} m, got {getattr(self, name):g} m: "
                    "take an Interface with it, for the curves of this trace alone"
                )

    @property
    def _units(self) -> dict[str, tuple[float, str]]:
        """The value of each normalised unit in SI units."""
        p = self.full_contact_pressure
        slope = specific_resistance(self.g_0 / p, self.composite_modulus, self.rho_1, self.rho_2)
        return {
            "lambda_0": (self.lambda_0, "m"),
            "g_0": (self.g_0, "m"),
            "p_0*": (p, "Pa"),
            "g_0/p_0*": (float(slope), "ohm m^2"),
            "p_0*/lambda_0^(1/2)": (p / math.sqrt(self.lambda_0), "Pa m^-0.5"),
        }

    def _of_unit(self, unit: str, normalised: Any) -> Any:
        """Values of one unit; a DataArray that says it is of another one is refused."""
        if not hasattr(normalised, "to_dataset"):
            return _scaled(normalised, self._units[unit][0])
        own = normalised.attrs.get("unit", unit)
        if own != unit:
            raise ValueError(
                f"normalised must be in {unit}, got {normalised.name} in {own}: take in_si, or another one"
            )
        return self.in_si(normalised.assign_attrs(unit=unit))

    def _converted(self, variable: Any) -> tuple[Any, Any, dict[str, Any]]:
        """Dimensions, values and attributes of a variable, in SI units where it has a unit."""
        attributes = dict(variable.attrs)
        unit = attributes.pop("unit", None)
        if unit not in self._units:
            return variable.dims, variable.values, dict(variable.attrs)
        factor, attributes["units"] = self._units[unit]
        if "symbol" in attributes:
            attributes["symbol"] = SI_SYMBOLS.get(attributes["symbol"], attributes["symbol"])
        limits = {name: attributes[name] * factor for name in ("valid_min", "valid_max") if name in attributes}
        return variable.dims, _scaled(variable.values, factor), attributes | limits


@beyond_floats
def _scaled(normalised: ArrayLike, unit: float) -> Array:
    """Values in a unit; NaN, where a value is missing, stays NaN.

    An infinite resistance is that of no contact, and stays infinite for perfect conductors, too, whose unit is 0.
    """
    values = checked_numbers("normalised", normalised)
    return np.asarray(np.multiply(values, unit, out=values.copy(), where=np.isfinite(values)))


def at_scale_of(curves: Any, bodies: Interface) -> Interface:
    """Two bodies at the length and height of the trace whose curves these are, or as they are for a series."""
    own = {name: float(np.squeeze(curves.coords.get(of_trace, math.nan))) for name, of_trace in OF_TRACE.items()}
    return replace(bodies, **own) if math.isfinite(own["g_0"]) else bodies
