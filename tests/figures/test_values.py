"""The values of a figure as CSV beside it."""

import csv
from io import StringIO

import numpy as np
import pytest

from tests.figures.test_figures import many_cases
from tests.figures.test_figures import studies as studies  # a fixture
from weier import Interface, figures
from weier.data.bodies import Bodies
from weier.figures import values
from weier.figures.tables import Values
from weier.scene import Figure, Grouping

BODIES = {"mu_1": 8e10, "mu_2": 8e10, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 2e-7, "rho_2": 2e-7, "lambda_0": 1e-3}


def table(wanted, given):
    return list(csv.DictReader(StringIO(values.as_csv(figures._drawn(wanted, given)))))


@pytest.mark.parametrize("si", [False, True])
def test_lines_and_bands_are_those_of_the_data(studies, si):
    bodies = Bodies(**BODIES, g_0=1e-6) if si else None
    one = studies["one"]
    pressures = bodies.pressure(one.mean_pressure.values) if bodies else None
    given = one.assign_coords(mean_pressure=("mean_pressure", pressures, {"units": "Pa"})) if bodies else one
    rows = table(Figure("compliance", interface=bodies), [given])
    x, y = ("mean pressure p (Pa)", "compliance h (m)") if si else ("mean pressure p/p_0*", "compliance h/g_0")
    assert list(rows[0])[:4] == ["panel", "curve", x, y]
    drawn = [(float(row[x]), float(row[y])) for row in rows if row["curve"] == "Demelio"]
    own = Values(one, "compliance")
    loads, h = own.line(0, own.methods.index("demelio"))
    scale = Interface(**BODIES, g_0=1e-6)
    expected = (scale.pressure(loads), scale.compliance(h)) if si else (loads, h)
    found = np.transpose(drawn)
    assert found == pytest.approx(np.array(expected), rel=1e-12)


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
