"""Limits on which results do not depend, as docs/numerics.md lists them: all of them at once, halved and doubled."""

import re
from pathlib import Path

import numpy as np
import pytest

from benchmarks.tuning import PACKAGE, copy_package, run_in, scale
from weier.methods.layer.nonlinear_layer import ACCURACY

PAGE = PACKAGE.parent / "docs" / "numerics.md"
SECTIONS = "Limits without an effect", "Limits of contact patches"
GRIDS_AND_LAYERS = """
import json
from math import inf
import numpy as np
from weier import Profile
from weier.methods import bem, layer

layers = Profile(1.25, 5, 3), Profile(1.7, 2, 6), Profile(1.25, 5, inf), Profile(1.3, 3, inf)
curves = [layer.curve(profile, [1e-12, 1e-4, 0.5, 2.0]) for profile in layers]
curves.append(bem.curve(Profile(1.5, 2, 4, (0.0, 1.0, 2.0, 3.0)), [0.02, 0.1, 0.5, 2.0], 128))
curves.append(bem.METHOD.solve(Profile(1.5, 2, 2), np.array([0.02, 0.1, 0.5, 2.0]), tolerance=1e-3))
print(json.dumps([[curve.compliance.tolist(), curve.resistance.tolist()] for curve in curves]))
"""
# Relative differences of h and R: the accuracy of tables and what it leaves of slopes; and the tolerance of tangents,
# by which boundary elements correct their staircase, far below the errors of any grid; and a tolerance of 1e-3 g_0
LARGEST = 4 * [(2 * ACCURACY, 2e-3)] + [(1e-7, 1e-5), (1e-3, 1e-2)]
# Each start, contacts and gaps, few and hundreds of them, beside a merger and through all events of a range of loads.
PATCHES = """
import json
import numpy as np
from weier import Profile
from weier.methods import patches

merging = 0.80812372 * (1 - np.array([1e-4, 1e-6, 1e-8]))
cases = [
    (1.25, 5, 3, (0.0, 1.0, 2.0), np.geomspace(1e-6, 9, 8)),
    (1.5, "5/2", 3, (0.0, 1.0, 2.0), np.geomspace(1e-3, 5, 6)),
    (1.1241528007905877, 2, 3, (3.731679150515029, 3.768119263993129, 0.9341084634895267), merging),
    (1.25, 5, 4, (0.0, 1.0, 2.0, 3.0), [0.3, 1.5, 8.0]),
    (1.5128, "6/5", 4, (0.7, 3.9, 4.9, 3.8), [0.3, 2.49]),
    (1.8, 3, 4, (1.0, 2.0, 3.0, 4.0), [1e-3, 1.0, 10.0]),
]
found = []
for *series, loads in cases:
    curve = patches.curve(Profile(*series), loads)
    values = curve.compliance, curve.compliance_error, curve.resistance, curve.resistance_error, curve.patch_count
    found.append([np.asarray(value, float).tolist() for value in values])
events = patches.events(Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), 0.3, 10.0)
print(json.dumps([found, events.mean_pressure.tolist(), events.birth.tolist()]))
"""


def limits(section: str) -> dict[str, list[str]]:
    """The names of each module in a table of the page."""
    text = PAGE.read_text(encoding="utf-8").split(f"## {section}\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([\w.]+)` \| (.*) \|$", text, re.MULTILINE)
    return {module: re.findall(r"`(\w+)`", names) for module, names in rows}


def usual_and_changed(folder: Path, section: str, program: str):
    """What the program prints, run with the package as it is, with halved and with doubled limits."""
    for factor in (1, 0.5, 2):
        (folder / str(factor)).mkdir()
        copy_package(folder / str(factor), limits(section), factor)
        yield run_in(folder / str(factor), program)


def test_the_page_lists_numbers_that_modules_assign(tmp_path):
    for module, names in (row for section in SECTIONS for row in limits(section).items()):
        path = tmp_path / f"{module}.py"
        before = (PACKAGE / "methods" / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")
        path.write_text(before, encoding="utf-8")
        scale(path, names, 2)
        assert path.read_text(encoding="utf-8") != before


def test_layers_and_grids_do_not_depend_on_limits(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")  # kernels as plain Python, which are not compiled
    usual, *changed = map(np.array, usual_and_changed(tmp_path, SECTIONS[0], GRIDS_AND_LAYERS))
    for curves in changed:
        assert np.all(np.abs(curves - usual) <= np.array(LARGEST)[..., None] * np.maximum(usual, 1e-3))


@pytest.mark.slow
def test_patches_do_not_depend_on_limits(tmp_path):
    """Kernels are compiled with the others: some minutes."""
    (usual, loads, births), *others = usual_and_changed(tmp_path, SECTIONS[1], PATCHES)
    for curves, other_loads, other_births in others:
        for (h, of_h, R, of_R, count), (h_2, of_h_2, R_2, of_R_2, count_2) in zip(usual, curves, strict=True):
            assert count == count_2
            for i in range(len(h)):
                assert abs(h[i] - h_2[i]) <= of_h[i] + of_h_2[i]
                assert abs(R[i] - R_2[i]) <= of_R[i] + of_R_2[i]
        assert births == other_births
        assert other_loads == pytest.approx(loads, rel=1e-9)
