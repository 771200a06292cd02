"""Contacts, as plans foresee them."""

import math

import numpy as np
import pytest

from weier import Profile, random_phases
from weier.methods import patches
from weier.methods.errors import ConvergenceError
from weier.methods.planned import forecast
from weier.methods.planned.forecast import contacts


@pytest.mark.parametrize(
    ("D", "gamma", "m", "loads"),
    [
        (1.5, 3, 4, np.geomspace(1e-9, 10, 12)),
        (1.5, "5/2", 3, np.geomspace(1e-9, 10, 12)),
        (1.25, 5, 5, [1e-9, 1e-3, 0.03, 0.1, 2, 8]),  # 625 waves: those of four terms are counted
        (1.4, "3/2", 7, [1e-9, 1e-3, 0.1, 1]),  # and here of five, in a quarter of the period
    ],
)
def test_contacts_are_foreseen_to_a_factor_of_two_in_nine_of_ten(D, gamma, m, loads):
    ratio = []
    for seed in range(3 if m < 5 else 1):
        profile = Profile(D, gamma, m, random_phases(seed))
        exact = patches.curve(profile, loads)
        here = exact.patch_count > 0
        ratio += (contacts(profile, np.asarray(loads, float))[here] / exact.patch_count[here]).tolist()
    assert np.median(ratio) == pytest.approx(1, abs=0.3)
    assert np.quantile(ratio, 0.05) > 1 / 3
    assert np.quantile(ratio, 0.95) < 3
    assert np.mean((np.array(ratio) > 0.5) & (np.array(ratio) < 2)) >= 0.75


def test_contacts_of_long_series_are_foreseen():
    """From the first terms, which are counted on a grid of 256 waves at most, whatever the series."""
    foreseen = contacts(Profile(1.25, 5, 8, tuple(range(8))), np.geomspace(1e-3, 10, 12))
    assert foreseen.max() == pytest.approx(42_673, rel=0.5)  # as many as contact patches find, in minutes (docs)


def test_where_contacts_cannot_be_counted_there_are_at_most_as_many_as_waves(monkeypatch):
    def fail(*_, **settings):
        raise ConvergenceError("none")

    monkeypatch.setattr(forecast.bem, "curve", fail)
    assert contacts(Profile(1.123, 5, 3, math.pi), np.array([0.1, 1.0])) == pytest.approx(25)
