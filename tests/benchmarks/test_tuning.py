"""The cost of tuned numbers: each is changed in a copy of the package."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

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


def test_costs_are_over_the_usual_ones(monkeypatch, tmp_path):
    def costs(program, changes, factor):
        return [8.0, 4.0, 2.0 * factor**2]

    monkeypatch.setattr(tuning, "costs", costs)
    found = CliRunner().invoke(tuning.main, ["--only", "REACH,NEIGHBOURS", "--output", str(tmp_path / "page.md")])
    lines = [line for line in found.output.splitlines() if line.startswith("|")]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines[2:]]
    assert rows == [
        ["`bem.edges`", "`REACH`", "1.00 / 1.00 / 0.25", "1.00 / 1.00 / 4.00"],
        ["`punches`", "`NEIGHBOURS`", "1.00 / 1.00 / 0.25", "1.00 / 1.00 / 4.00"],
    ]


def test_results_do_not_depend_on_any_of_them():
    """They are in the tables whose limits are halved and doubled by the tests of results."""
    rows = dict(re.findall(r"^\| `([\w.]+)` \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    listed = {module: rows.get(module.removeprefix("patches."), "") for module, _ in NUMBERS}
    assert [f"{module}.{name}" for module, name in NUMBERS if f"`{name}`" not in listed[module]] == []
