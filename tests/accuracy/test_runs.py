"""Variants on cases in one dataset: each value in its place, and everything described."""

import json

import numpy as np
import pytest

from weier import Profile
from weier.accuracy import extremes, runs, tradeoff
from weier.accuracy.runs import Comparison
from weier.accuracy.variants import Variant
from weier.data.variables import CURVE, RUN, Variable
from weier.scene import Case

COARSE, FINE = (Variant(f"bem {points}", "bem", {"points_per_wave": points}) for points in (12, 24))
SUM = Variant("demelio", "demelio", {})
OWN = {"mood": Variable(CURVE, "a number"), "remark": Variable(RUN, "a text", dtype="O")}


@pytest.fixture
def comparisons():
    one, two = (Case({"D": 1.25, "gamma": 5, "m": m}, (), {}) for m in (1, 2))
    return [
        Comparison("one", one, np.array([0.1, 1.0]), (SUM,)),
        Comparison("two", two, np.array([0.5]), (COARSE, FINE, SUM)),
    ]


def test_each_value_stands_at_its_case_variant_and_load(comparisons):
    data = runs.blank(comparisons, ("compliance", "settings"), OWN)

    def measured(comparison, variant):
        return {"mood": comparison.loads * 2, "remark": f"{comparison.name} by {variant.name}", "unknown": 1.0}

    runs.fill(data, comparisons, measured)
    assert data["variant"].values.tolist() == ["bem 12", "bem 24", "demelio"]
    assert data["solution_method"].values.tolist() == ["bem", "bem", "demelio"]
    assert data["mean_pressure"].values.tolist() == [0.1, 0.5, 1.0]
    nan = np.nan
    np.testing.assert_array_equal(data["mood"].sel(variant="demelio"), [[0.2, nan, 2.0], [nan, 1.0, nan]])
    assert np.isnan(data["mood"].values[0, :2]).all()
    assert data["remark"].values[0].tolist() == ["", "", "one by demelio"]
    assert data["remark"].values[1].tolist() == [f"two by {name}" for name in data.variant.values]
    assert json.loads(data["settings"].values[1, 1]) == {"points_per_wave": 24}
    assert data["m"].values.tolist() == [1, 2]
    assert {"compliance", "settings", "mood", "remark", "total_amplitude"} <= set(data.data_vars)
    assert not {"unknown", "resistance"} & set(data.data_vars)


def test_all_variables_are_described(comparisons):
    data = runs.blank(comparisons, ("compliance",), OWN)
    assert all("long_name" in data[name].attrs for name in data.variables)


def test_variants_have_names_of_their_own():
    """Else the numbers of one would stand in the place of those of another."""
    profile = Profile(1.25, 5, 2)
    for listed in (tradeoff.variants(profile), extremes.ill_conditioned.variants(profile, np.array([0.1]))):
        assert len({variant.name for variant in listed}) == len(listed) > 1
