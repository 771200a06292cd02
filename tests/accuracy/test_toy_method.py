"""A method that is only listed takes part in the trade and in the extremes, their tables and their figures."""

from dataclasses import replace

import numpy as np
import pytest

from tests.toy import FIRST_WAVE
from tests.trade import small_trade
from weier import Profile, figures
from weier.accuracy import extremes, tradeoff
from weier.accuracy.comparison import Comparison
from weier.accuracy.extremes.cases import MAX_SECONDS, variants
from weier.data import dataset
from weier.methods import registry, westergaard
from weier.scene import Case

LOADS = np.array([0.01, 0.1, 2.0])


@pytest.fixture(autouse=True)
def listed(monkeypatch):
    """The toy among the methods of the package."""
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, FIRST_WAVE))


def test_the_trade_measures_all_its_variants(tmp_path):
    data = small_trade(tmp_path, max_points=100)
    mine = data.isel(variant=data["solution_method"].values == FIRST_WAVE.name)
    assert mine["variant"].values.tolist() == ["first wave 0.5", "first wave 0.9"]
    one = mine.isel(case=0).sel(variant="first wave 0.9")
    assert one["compliance_error"].values == pytest.approx(0.1 * westergaard.compliance(LOADS), rel=1e-12)
    dataset.write(data, tmp_path / "toy.nc", "Toy")
    tradeoff.write_table(dataset.read(tmp_path / "toy.nc"), "Toy", tmp_path / "toy.md")
    assert "| first wave 0.5 | 2 |" in (tmp_path / "toy.md").read_text()
    figures.draw("work_precision", [data], "", tmp_path / "toy.png")


def test_the_extremes_examine_it(tmp_path):
    cases = [Case({"D": 1.5, "gamma": 3, "m": m}, (), {}) for m in (1, 2)]
    some = [Comparison(f"{case.profile.m} waves", case, LOADS, variants(case.profile, LOADS)) for case in cases]
    data = extremes.measure(some)
    assert extremes.failures(data) == []
    toy = data.sel(variant=FIRST_WAVE.name)
    assert toy["compliance_digits"].values[0].min() > 15  # for one wave it is Westergaard's
    assert np.isnan(toy["compliance_digits"].values[1]).all()  # an estimate that says nothing of what it should be
    assert (toy["within_band"] == 1).all()
    extremes.write_table(data, "Toy", tmp_path / "toy.md")
    assert "| 2 waves | first wave | 3: " in (tmp_path / "toy.md").read_text()
    figures.draw("extremes", [data], "", tmp_path / "toy.png")


def test_it_is_left_out_where_it_takes_too_long(monkeypatch):
    profile = Profile(1.5, 3, 2)
    assert FIRST_WAVE.name in [variant.name for variant in variants(profile, LOADS)]
    slow = replace(FIRST_WAVE, seconds=lambda profile, loads: MAX_SECONDS * loads.size / 5)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS[:-1], slow))
    assert FIRST_WAVE.name not in [variant.name for variant in variants(profile, LOADS)]
    assert FIRST_WAVE.name in [variant.name for variant in variants(profile, LOADS[:1])]
