"""Limits on which results do not depend, as docs/numerics.md lists them: all of them at once, halved and doubled.

Kernels run as plain Python, which takes changed numbers of a module without being compiled again.
"""

import json
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from weier.methods.layer.nonlinear_layer import ACCURACY

PAGE = Path(__file__).parents[2] / "docs" / "numerics.md"
SOLVE = """
import json, sys
from importlib import import_module
from math import inf
from weier import Profile
from weier.methods import bem, layer

def both(curve):
    return curve.compliance, curve.resistance


names, factor = json.loads(sys.argv[1]), float(sys.argv[2])
for module, limits in names.items():
    changed = import_module(f"weier.methods.{module}")
    for name in limits:
        number = getattr(changed, name)
        setattr(changed, name, max(1, round(number * factor)) if isinstance(number, int) else number * factor)
loads, few = [1e-4, 0.5, 2.0], Profile(1.5, 2, 4, (0.0, 1.0, 2.0, 3.0))
found = {
    "layer": [both(layer.curve(Profile(*series), loads)) for series in [(1.25, 5, 3), (1.25, 5, inf)]],
    "bem": [both(bem.curve(few, loads[1:], 128))],
}
print(json.dumps({method: [[v.tolist() for v in both] for both in curves] for method, curves in found.items()}))
"""
# Relative differences of h and R: the accuracy of tables and what it leaves of slopes; and the tolerance of tangents,
# by which boundary elements correct their staircase, far below the errors of any grid
LARGEST = {"layer": (2 * ACCURACY, 2e-3), "bem": (1e-7, 1e-5)}


def limits() -> dict[str, list[str]]:
    """The names of each module in the table of the page."""
    section = PAGE.read_text(encoding="utf-8").split("## Limits without an effect\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([\w.]+)` \| (.*) \|$", section, re.MULTILINE)
    return {module: re.findall(r"`(\w+)`", names) for module, names in rows}


@cache
def solved(factor: float) -> dict[str, np.ndarray]:
    """Compliance and resistance of all curves of each method."""
    program = [sys.executable, "-c", SOLVE, json.dumps(limits()), str(factor)]
    done = subprocess.run(program, env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {method: np.array(curves) for method, curves in json.loads(done.stdout).items()}


@pytest.mark.parametrize("factor", [0.5, 2])
def test_results_do_not_depend_on_limits(factor: float) -> None:
    usual, changed = solved(1), solved(factor)
    for method, largest in LARGEST.items():
        for quantity in range(2):
            difference = np.abs(changed[method][:, quantity] - usual[method][:, quantity])
            scale = np.maximum(usual[method][:, quantity], 1e-3)
            assert np.all(difference <= largest[quantity] * scale), (method, quantity, (difference / scale).max())
