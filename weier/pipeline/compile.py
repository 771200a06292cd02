"""All kernels compiled, once for all later runs: `weier compile`, and before a batch is solved."""

from __future__ import annotations

import fcntl
import hashlib
import math
from contextlib import suppress

import numpy as np

from weier.kernels import jit
from weier.kernels.sources import PACKAGE
from weier.methods import registry
from weier.methods.errors import NotApplicableError
from weier.methods.fields import events, fields
from weier.methods.solve import solve
from weier.theory.profile import Profile

LOADS = np.geomspace(1e-3, 10, 12)  # few contacts and few gaps: the patches have a problem of their own for each
TWO_WAVES = Profile(D=1.25, gamma=2, m=2)
INFINITE = Profile(D=1.02, gamma=10, m=math.inf)  # whose first terms say all but all of it: small grids
# Files in the folder of compiled kernels, where each copy of the package has its own.
COPY = hashlib.sha256(str(PACKAGE).encode()).hexdigest()[:16]
COMPLETE, LOCK = f"complete-{COPY}", f"lock-{COPY}"


def compile_once() -> None:
    """Compile all kernels unless the cache holds them, in one process while the others wait for it.

    So no two jobs compile the same kernel side by side.
    """
    folder = jit.cache_folder()
    if jit.disabled() or (folder / COMPLETE).exists():
        return
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = (folder / LOCK).open("w")
    except OSError:  # closed to writing: numba compiles each kernel when it is called
        return
    with lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # until it is closed, or the process ends
        if not (folder / COMPLETE).exists():
            compile_kernels()


def compile_kernels() -> None:
    """Run whatever has kernels on two waves and on the infinite series, so that numba keeps them in its cache."""
    if jit.disabled():
        return
    for profile, loads in ((TWO_WAVES, LOADS), (INFINITE, LOADS[:1])):
        for method in registry.METHODS:
            for settings in (*method.algorithms, *method.options):
                with suppress(NotApplicableError):
                    solve(profile, loads, method.name, **settings)
    fields(TWO_WAVES, 0.1)
    events(TWO_WAVES, LOADS[0], LOADS[-1])
    (jit.cache_folder() / COMPLETE).touch()
