"""All kernels compiled, once for all later runs: `weier compile`."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from weier.kernels import jit
from weier.methods import registry
from weier.methods.errors import NotApplicableError
from weier.methods.fields import events, fields
from weier.methods.solve import solve
from weier.theory.profile import Profile

LOADS = np.geomspace(1e-3, 10, 12)  # few contacts and few gaps: the patches have a problem of their own for each


def compile_kernels() -> None:
    """Run whatever has kernels on two waves, so that numba keeps them in its cache."""
    if jit.disabled():
        return
    profile = Profile(D=1.25, gamma=2, m=2)
    for method in registry.METHODS:
        for settings in method.algorithms:
            with suppress(NotApplicableError):
                solve(profile, LOADS, method.name, **settings)
    fields(profile, 0.1)
    events(profile, LOADS[0], LOADS[-1])
