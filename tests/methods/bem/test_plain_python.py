"""The kernels as plain Python give what they give compiled."""

import json
import os
import subprocess
import sys

import pytest

PROGRAM = """
import json
import numpy as np
from weier import Profile
from weier.kernels import jit
from weier.methods.bem import curve

profile = Profile(1.25, 3, 2, (0.0, 1.0))
loads = np.array([0.01, 0.3, 4.0])
curves = [curve(profile, loads, points=48, solver=solver) for solver in ("fft", "direct")]
print(json.dumps([jit.disabled(), [[c.compliance.tolist(), c.resistance.tolist()] for c in curves]]))
"""


def run(disabled):
    environment = os.environ | {"NUMBA_DISABLE_JIT": str(disabled)}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def test_compiled_and_plain_kernels_agree():
    """To the residual of 1e-10 that both stop at."""
    plain, compiled = run(1), run(0)
    assert (plain[0], compiled[0]) == (True, False)
    for one, other in zip(plain[1], compiled[1], strict=True):
        assert one[0] == pytest.approx(other[0], abs=1e-9)
        assert one[1] == pytest.approx(other[1], rel=1e-9, abs=1e-12)
