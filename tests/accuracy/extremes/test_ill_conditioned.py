"""Which methods meet an extreme, and at which loads."""

import math

import numpy as np
import xarray as xr

from weier import Profile
from weier.accuracy.extremes import extremes, ill_conditioned
from weier.accuracy.extremes.ill_conditioned import around, neighbours, variants

USUAL = np.geomspace(1e-6, 100, 25)


def names(profile, loads=USUAL):
    return {variant.name: dict(variant.settings) for variant in variants(profile, loads)}


def test_every_method_meets_what_it_applies_to():
    assert {"westergaard", "layer", "bem", "patches", "auto"} <= names(Profile(1.25, 5, 1)).keys()
    assert "westergaard" not in names(Profile(1.25, 5, 3))


def test_slow_methods_meet_few_loads():
    long = Profile(1.25, 5, 1000)
    assert "layer" not in names(long)
    assert "layer" in names(long, USUAL[:1])
    infinite, of_infinite = Profile(1.25, 5, math.inf), {"archard", "demelio", "persson", "layer"}
    assert names(infinite).keys() == of_infinite  # by "auto" 15 625 waves, twice under each load
    assert names(infinite, USUAL[:1]).keys() == {*of_infinite, "auto"}


def test_a_tolerance_out_of_reach_is_tried_for_its_refusal():
    assert "auto" in names(Profile(1.9, 2, math.inf))


def test_what_no_computer_holds_is_tried_for_its_refusal():
    found = names(Profile(1.5, 10**6, 1000))
    assert {"bem", "patches"} <= found.keys()
    assert "layer" not in found


def test_loads_stand_beside_and_around():
    ulp = np.finfo(float).eps
    assert neighbours(1.0).tolist() == [1 - ulp, 1 - ulp / 2, 1.0, 1 + ulp, 1 + 2 * ulp]
    assert around([1.0]).tolist() == sorted([1.0, *(1 + s * d for s in (-1, 1) for d in ill_conditioned.DISTANCES)])


def test_each_extreme_has_a_name_of_its_own_and_loads_that_increase(monkeypatch):
    monkeypatch.setattr(ill_conditioned, "events", lambda *_: {"mean_pressure": xr.DataArray(USUAL)})
    found = list(extremes())
    assert len({comparison.name for comparison in found}) == len(found) > 30
    assert all((np.diff(comparison.loads) > 0).all() and comparison.variants for comparison in found)
