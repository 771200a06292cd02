"""Kernels compiled in advance: those of all methods by `weier compile`, and those of one before it solves batches."""

from __future__ import annotations

import math
from collections.abc import Collection
from contextlib import suppress

import numpy as np

from weier.api.fields import fields
from weier.api.task import CurveTask
from weier.methods import registry
from weier.methods.errors import NotApplicableError
from weier.methods.method import CURVES, OTHERS
from weier.methods.registry import find_method
from weier.surface.profile import Profile

# Few contacts and few gaps: contact patches have separate kernels for the two.
LOADS = np.geomspace(1e-3, 10, 16)
TWO_WAVES = Profile(D=1.25, gamma=2, m=2)  # Two waves suffice to reach all kernels of finite series.
INFINITE = Profile(D=1.02, gamma=10, m=math.inf)  # A small tail needs only small grids.


def compile_kernels(names: Collection[str] = ()) -> None:
    """Compile the kernels of some methods or shares, or of all and of fields, by running them."""
    for name in names or registry.names():
        method = find_method(name.removesuffix(CURVES).removesuffix(OTHERS))
        if method.run_kernels and not name.endswith(CURVES):
            method.run_kernels()
        if not name.endswith(OTHERS):
            for profile, loads in ((TWO_WAVES, LOADS), (INFINITE, LOADS[:1])):
                with suppress(NotApplicableError):
                    CurveTask(profile, method.name, {}, loads).solve()
    if not names:
        fields(TWO_WAVES, 0.1)
