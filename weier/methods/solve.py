"""One profile, one method, many loads."""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter
from typing import Any

from weier.kernels.arrays import Array
from weier.kernels.jit import COMPILING_SECONDS
from weier.methods.method import Method
from weier.surface.waves import Waves


def solve_checked(profile: Waves, loads: Array, method: Method, settings: Mapping[str, Any]) -> tuple[Any, float]:
    """The solution of a method, its own tuple of arrays and scalars, and the seconds without compiling.

    The caller has checked loads and names of settings.
    """
    method.check_applies(profile)
    start, compiling = perf_counter(), COMPILING_SECONDS.get()
    solution = method.solve(profile, loads, **settings)
    return solution, perf_counter() - start - (COMPILING_SECONDS.get() - compiling)
