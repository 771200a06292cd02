"""A method that is only listed takes part in the trade and in the extremes, their tables and their figures."""

import numpy as np
import pytest

from tests.toy_method import TOY
from tests.trade import small_trade
from weier import figures
from weier.accuracy import extremes, reference, tradeoff
from weier.accuracy.extremes.ill_conditioned import variants
from weier.accuracy.runs import Comparison
from weier.data import dataset
from weier.data.variables import Check
from weier.methods import registry
from weier.scene import Case, Figure

LOADS = np.array([0.01, 0.1, 2.0])


def list_method(monkeypatch, method):
    """List a method after those of the package."""
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, method))


def test_the_trade_measures_all_its_variants(monkeypatch, tmp_path):
    list_method(monkeypatch, TOY)
    data = small_trade(tmp_path, max_points=100)
    mine = data.isel(variant=data["solution_method"].values == TOY.name)
    assert mine["variant"].values.tolist() == ["toy"]
    half = mine.isel(case=1).sel(variant="toy")  # the toy is for several waves
    right = data["reference_compliance"].values[1]
    assert half["compliance_deviation"].values == pytest.approx(np.abs(0.5 * LOADS - right), rel=1e-12)
    assert np.isnan(mine["seconds"].values[0]).all()
    dataset.write(data, tmp_path / "toy.nc", "Toy")
    assert "| toy | 1 |" in tradeoff.table_of(dataset.read(tmp_path / "toy.nc"))
    figures.draw(Figure("work_precision"), [data], tmp_path / "toy.png")


def test_the_extremes_examine_it_and_find_its_faults(monkeypatch, tmp_path):
    """Against a reference of its own it is exact; at heavy loads it rises beyond full contact."""

    def exact(profile, loads):
        return reference.Reference(0.5 * loads, np.full(loads.size, 0.5), "a half")

    monkeypatch.setitem(reference.ESTIMATE_REFERENCES, "toy", exact)
    list_method(monkeypatch, TOY)
    case = Case({"D": 1.5, "gamma": 3, "m": 2}, (), {})
    loads = 20 * LOADS
    some = [Comparison("two waves", case, loads, variants(case.profile, loads))]
    data = extremes.measure(some)
    toy = data.sel(variant=TOY.name).isel(case=0)
    assert (toy["compliance_digits"] == 16).all()
    assert toy["reference"].item() == "a half"
    assert toy["monotone"].item() == toy["concave"].item() == Check.yes
    assert extremes.failures(data) == [
        "two waves, toy: not within band",
    ]
    assert "\n- two waves, toy: not within band\n" in "\n".join([*extremes.parts(data), ""])
    figures.draw(Figure("extremes"), [data], tmp_path / "toy.png")
