"""The values of a figure as CSV beside it."""

import csv
from io import StringIO

import numpy as np
import pytest

from tests.figures.test_figures import many_cases
from tests.figures.test_figures import studies as studies  # a fixture
from weier import figures
from weier.figures import values
from weier.figures.tables import Values
from weier.scene import Figure, Grouping


def table(wanted, given):
    return list(csv.DictReader(StringIO(values.as_csv(figures._drawn(wanted, given)))))


def test_lines_are_those_of_the_data(studies):
    """In SI units, too, in tests/scene/test_loads_in_pascal.py."""
    one = studies["one"]
    rows = table(Figure("compliance"), [one])
    x, y = "mean pressure p/p_0*", "compliance h/g_0"
    assert list(rows[0])[:4] == ["panel", "curve", x, y]
    drawn = [(float(row[x]), float(row[y])) for row in rows if row["curve"] == "Demelio"]
    own = Values(one, "compliance")
    expected = own.line(0, own.methods.index("demelio"))
    assert np.transpose(drawn) == pytest.approx(np.array(expected), rel=1e-12)


def test_a_band_has_its_two_ends():
    study = many_cases()
    study["resistance"].values[:] *= (1 + 0.1 * np.arange(study.sizes["case"]))[:, None, None]  # else all are equal
    grouping = Grouping(median_over=("m",))
    rows = table(Figure("resistance", grouping=grouping), [study])
    band = [
        row for row in rows if row["curve"].endswith(", 10 to 90 %") and row["curve"].startswith("contact patches")
    ]
    method = study["solution_method"].values.tolist().index("patches")
    known = study["resistance"].values[:, method]
    for row, low, high in zip(band, *np.percentile(known, [10, 90], axis=0), strict=True):
        ends = [float(row[f"resistance (dh/dp) p_0*/g_0, {end}"]) for end in ("low", "high")]
        assert ends == pytest.approx([low, high], rel=1e-12)
        assert row["resistance (dh/dp) p_0*/g_0"] == ""


# The message needs contact fractions of several terms, which its own test has.
@pytest.mark.parametrize("kind", [kind for kind in figures.KINDS if kind != "message"])
def test_every_figure_has_values_in_plain_text(studies, kind):
    rows = table(Figure(kind), [studies["terms"]])
    assert rows
    for row in rows:
        assert not set("$\\{}") & set("".join([*row, row["panel"], row["curve"]]))
        numbers = [value for name, value in row.items() if name not in ("panel", "curve") and value]
        assert np.isfinite(np.array(numbers, float)).any()
