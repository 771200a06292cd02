"""Marks that tests of several folders bear."""

import pytest

from weier.kernels import jit

# Where a developer sets it, to follow kernels line by line; the gate does not, and runs these tests.
compiled = pytest.mark.skipif(jit.disabled(), reason="NUMBA_DISABLE_JIT is set: nothing is compiled")
