"""The cost of tuned numbers: each is changed in a copy of the package."""

import re
from pathlib import Path

import pytest

from benchmarks import tuning

PAGE = Path(__file__).parents[2] / "docs" / "numerics.md"
NUMBERS = tuning.BEM_CONSTANTS + tuning.PATCHES_CONSTANTS


def test_a_number_is_changed_in_a_copy_and_its_cost_is_that_of_the_copy():
    program = "from weier.methods.bem import edges\nfound = [edges.REACH, edges.__file__]\n"
    (usual, here), (changed, there) = (
        tuning.costs(program, {"bem.edges": ["REACH"]} if factor > 1 else {}, factor) for factor in (1, 2)
    )
    assert changed == 2 * usual > 0
    assert not {here, there} & {str(tuning.PACKAGE / "methods" / "bem" / "edges.py")}


def test_a_name_without_a_number_is_refused(tmp_path):
    (tmp_path / "module.py").write_text("A, B = 1, 2.0\n")
    tuning.scale(tmp_path / "module.py", ["A", "B"], 0.25)
    assert (tmp_path / "module.py").read_text() == "A, B = 1, 0.5\n"
    with pytest.raises(ValueError, match=r"module\.py assigns no number to C"):
        tuning.scale(tmp_path / "module.py", ["A", "C"], 2)


def test_results_do_not_depend_on_any_of_them():
    """They are in the tables whose limits are halved and doubled by the tests of results."""
    rows = dict(re.findall(r"^\| `([\w.]+)` \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    listed = {module: rows.get(module.removeprefix("patches."), "") for module, _ in NUMBERS}
    assert [f"{module}.{name}" for module, name in NUMBERS if f"`{name}`" not in listed[module]] == []
