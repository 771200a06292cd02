"""Limits on which results do not depend, as docs/numerics.md lists them: all of them at once, halved and doubled."""

import re
from pathlib import Path

import pytest

import weier
from benchmarks import tuning
from benchmarks.tuning import scale

PACKAGE = Path(weier.__file__).parent
PAGE = PACKAGE.parent / "docs" / "numerics.md"
# Each start, contacts and gaps, few and hundreds of them, beside a merger and through all events of a range of loads.
SOLVE = """
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


def limits():
    """The names of each module in the table of the page, which leaves out the room of contact patches."""
    section = PAGE.read_text(encoding="utf-8").split("## Limits of contact patches\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", section, re.MULTILINE)
    return {
        module if (PACKAGE / "methods" / f"{module}.py").exists() else f"patches.{module}": re.findall(
            r"`(\w+)`", names
        )
        for module, names in rows
    }


def test_the_page_lists_numbers_that_modules_assign(tmp_path):
    for module, names in limits().items():
        path = tmp_path / f"{module}.py"
        before = (PACKAGE / "methods" / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")
        path.write_text(before, encoding="utf-8")
        scale(path, names, 2)
        assert path.read_text(encoding="utf-8") != before


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.5, 2])
def test_results_do_not_depend_on_limits(tmp_path, factor):
    """Kernels are compiled with the others: a minute or two."""
    found = []
    for name, changes in (("usual", {}), ("changed", limits())):
        (tmp_path / name).mkdir()
        tuning.copy_package(tmp_path / name, changes, factor)
        found.append(tuning.run_in(tmp_path / name, SOLVE))
    (usual, loads, births), (curves, other_loads, other_births) = found
    for (h, of_h, R, of_R, count), (h_2, of_h_2, R_2, of_R_2, count_2) in zip(usual, curves, strict=True):
        assert count == count_2
        for i in range(len(h)):
            assert abs(h[i] - h_2[i]) <= of_h[i] + of_h_2[i]
            assert abs(R[i] - R_2[i]) <= of_R[i] + of_R_2[i]
    assert births == other_births
    assert other_loads == pytest.approx(loads, rel=1e-9)
