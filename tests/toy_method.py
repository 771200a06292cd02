"""A method that is not of the package: half of the load for the compliance, exact by its own account."""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.errors import NotApplicableError
from weier.methods.method import Method, Range, Setting, Style
from weier.surface.profile import Profile


def _solve(profile: Profile, loads: Array, fraction: float = 0.5) -> Curve:
    return Curve(fraction * loads, np.full(loads.size, fraction))


def _applies(profile: Profile) -> None:
    if profile.m == 1:
        raise NotApplicableError("the toy is for several waves, got m = 1: take westergaard")


TOY = Method(
    name="toy",
    label="a toy",
    summary="half of the load; m > 1",
    solve=_solve,
    settings={"fraction": Setting(0.5, "part of the load", Range(0.0, 1.0))},
    infinite=True,
    applies=_applies,
    style=Style("#123456", (7, 2), "p"),
)
