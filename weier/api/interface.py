"""`weier.Interface`: two bodies, whose contact is solved from Pa to m and ohm m^2, or K m^2/W for heat."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr
from numpy.typing import ArrayLike

from weier import units
from weier.api.inverse import loads_for, wanted_quantity
from weier.api.solve import in_order, solve_under
from weier.data.bodies import Bodies, to_normalised
from weier.data.si import with_pressures_in
from weier.data.variables import VARIABLES
from weier.methods.load_progress import converting
from weier.surface.loads import listed_loads
from weier.surface.waves import Waves


class Interface(Bodies):
    """Two bodies in contact, in SI units: solves for their surfaces and converts normalised results.

    Values may be quantities of pint or astropy, or arrays with the attribute `units`.

    Parameters
    ----------
    mu_1, mu_2 : float
        Shear moduli, in Pa. One may be inf, for a rigid body.
    E_1, E_2 : float
        Young's moduli E = 2 mu (1 + nu), in Pa, instead of mu_1 or mu_2.
    nu_1, nu_2 : float
        Poisson's ratios, in (-1, 0.5].
    rho_1, rho_2 : float
        Resistivities, in ohm m; 0 for a perfect conductor.
    k_1, k_2 : float
        Instead of both, thermal conductivities, in W/(m K): resistance is that of heat, in K m^2/W, and 1/resistance
        the contact conductance.
    lambda_0, g_0 : float, optional
        Wavelength and amplitude of the coarsest wave of a series, in m. Curves of a `Trace` have their own.
    hardness_1, hardness_2 : float, optional
        Indentation hardnesses, in Pa. Results then warn of loads at which the mean pressure of the contacts, p over
        the contact fraction, exceeds 0.47 of the lower one, where line contacts begin to yield, and of loads at which
        this cannot be judged, since the method returns no contact area.

    Raises
    ------
    ValueError
        If a value is out of range or has a unit of another quantity, if both or neither of mu and E, or of
        resistivities and conductivities, are given, or if both bodies are rigid.

    Warns
    -----
    UserWarning
        If a shear modulus is below 1 MPa or above 10 TPa, a resistivity not that of a conductor, 1e-8 to 1e-3 ohm m,
        a conductivity outside 0.01 to 1e4 W/(m K), a hardness outside 1e6 to 2e11 Pa, lambda_0 above 1 m, or
        g_0/lambda_0 outside 1e-8 to 0.2.
        With a hardness, if contacts of a result yield, or if this cannot be judged.

    Examples
    --------
    >>> import weier
    >>> copper = {"mu_1": 45e9, "mu_2": 45e9, "nu_1": 0.34, "nu_2": 0.34, "rho_1": 1.7e-8, "rho_2": 1.7e-8}
    >>> contact = weier.Interface(**copper, lambda_0=1e-3, g_0=1e-6)
    >>> print(f"{contact.pressure(0.1) / 1e6:.1f} MPa, {contact.resistance(2.5):.2e} ohm m2")
    21.4 MPa, 1.35e-11 ohm m2

    """

    def solve(
        self,
        surface: Waves | Sequence[Waves],
        pressure: ArrayLike,
        method: str | Sequence[str] | None = None,
        **options: Any,
    ) -> xr.Dataset:
        """Return compliance and contact resistance in m and ohm m^2, or K m^2/W for heat, under pressures in Pa.

        Parameters
        ----------
        surface : Profile, Trace or sequence of these
            A series needs lambda_0 and g_0 of this interface; a trace has its own.
        pressure : array_like, shape (loads,)
            Positive, in Pa, or in another unit that they carry; the result has that of the first.
        method, **options
            As of `weier.solve`; a `tolerance` is in g_0.

        Returns
        -------
        Dataset
            As of `weier.solve`, in SI units except for the unit of the pressures, with the values of this interface
            as attributes. Several surfaces are cases with common pressures.

        Raises
        ------
        ValueError, ConvergenceError
            As of `weier.solve`.

        Examples
        --------
        >>> import numpy as np
        >>> import weier
        >>> steel = weier.Interface(E_1=210e9, E_2=210e9, nu_1=0.3, nu_2=0.3, rho_1=1.4e-7, rho_2=1.4e-7)
        >>> x = 5e-6 * np.arange(200)
        >>> z = 1e-6 * np.cos(2 * np.pi * x / 2e-4) + 2e-7 * np.cos(2 * np.pi * x / 4e-5 + 1)
        >>> trace = weier.Trace(z, length=1e-3, ends="periodic", unit="m")
        >>> curve = steel.solve(trace, [1e6, 1e7])
        >>> print(curve.resistance.values.round(13), curve.resistance.units)
        [8.27e-11 6.21e-11] ohm m^2
        """
        loads, position = listed_loads(pressure, "pressure", units.PASCAL)
        unit = units.unit_of(pressure[0] if isinstance(pressure, list | tuple) and pressure else pressure)

        def in_si(solved: xr.Dataset) -> xr.Dataset:
            return with_pressures_in(self.in_si(solved), unit)

        with converting(in_si):
            solved = solve_under(surface, loads, self, method, **options)
        return in_si(in_order(solved, position))

    def find_pressure(
        self,
        surface: Waves,
        *,
        resistance: ArrayLike | None = None,
        compliance: ArrayLike | None = None,
        contact_fraction: ArrayLike | None = None,
    ) -> xr.Dataset:
        """Return the mean pressure in Pa at which one quantity has a given value.

        Parameters
        ----------
        surface : Profile or Trace
            A series needs lambda_0 and g_0 of this interface; a trace has its own.
        resistance, compliance, contact_fraction : array_like
            One of these, in ohm m^2 or K m^2/W, in m, or as a fraction: one or several values.

        Returns
        -------
        Dataset
            As of `weier.find_load`, in SI units.

        Raises
        ------
        ValueError, ConvergenceError
            As of `weier.find_load`.

        Examples
        --------
        >>> import weier
        >>> bodies = {"E_1": 210e9, "E_2": 210e9, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 1.4e-7, "rho_2": 1.4e-7}
        >>> steel = weier.Interface(**bodies, lambda_0=1e-3, g_0=1e-6)
        >>> found = steel.find_pressure(weier.Profile(D=1.25, gamma=5, m=2), resistance=1e-10)
        >>> print(f"{found.mean_pressure.item():.4g} {found.mean_pressure.units}")
        4.305e+07 Pa
        """
        own, (name, value) = self.at(surface), wanted_quantity(resistance, compliance, contact_fraction)
        normalised = to_normalised(own, name, VARIABLES[name].unit, value)
        return own.in_si(loads_for(surface, name, normalised, own.scales()))
