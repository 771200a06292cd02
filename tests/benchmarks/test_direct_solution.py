"""The times on which the limit of direct solutions is based are those of the same solutions."""

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import direct_solution
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS


@pytest.mark.parametrize("kind", [CONTACTS, GAPS])
def test_both_solutions_are_the_same(kind):
    segments = direct_solution.random_segments(12)
    (direct, first), (iterative, second) = (direct_solution.solve(segments, kind, way) for way in (True, False))
    np.testing.assert_allclose(direct.force, iterative.force, rtol=1e-8)
    assert first.plane == pytest.approx(second.plane, rel=1e-10)
    assert direct.even is not None
    assert iterative.steps > 3


def test_the_table_has_a_ratio_for_contacts_and_gaps(monkeypatch, tmp_path):
    monkeypatch.setattr(direct_solution, "SEGMENTS", (4, 8))
    found = CliRunner().invoke(direct_solution.main, ["--rounds", "1", "--output", str(tmp_path / "page.md")])
    assert found.exit_code == 0, found.output
    cells = [line.split("|")[1:-1] for line in found.output.splitlines() if line.startswith("|")][2:]
    assert [int(row[0]) for row in cells] == [32, 64]
    assert all(0 < float(cell) < 1 for row in cells for cell in row[1:])
