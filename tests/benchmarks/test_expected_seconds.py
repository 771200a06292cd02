"""Seconds over those expected."""

import numpy as np
import pytest

from benchmarks import expected_seconds
from weier.accuracy.variants import Variant
from weier.methods.registry import find_method


def test_surfaces_have_at_most_as_many_waves_or_infinitely_many():
    kinds, profiles = zip(*expected_seconds.surfaces(100), strict=True)
    waves = [profile.waves_per_period[-1] for profile in profiles if np.isfinite(profile.m)]
    assert max(waves) == 100
    assert (kinds.count("m = inf"), kinds.count("traces")) == (len(expected_seconds.SERIES), 2)


def test_a_row_has_the_least_and_the_largest_ratio(monkeypatch):
    """Single loads, of which the mean counts, and many."""
    monkeypatch.setattr(expected_seconds, "_seconds", lambda variant, profile, loads: profile.m * loads.size)
    monkeypatch.setattr(expected_seconds, "FRACTIONS", (0.1, 0.2))
    rows = list(expected_seconds.rows(Variant("by default", "archard", {}), 3))
    assert [row[:5] for row in rows if row[2] == "series"] == [
        ["archard", "by default", "series", "1", "6"],
        ["archard", "by default", "series", "40", "6"],
    ]
    expected = expected_seconds.find_method("archard").seconds(None, np.ones(1))
    assert rows[-1][-2:] == ["40 to 80", f"{40 / expected:.2g} to {80 / expected:.2g}"]


@pytest.mark.parametrize("method", ["bem", "layer", "patches"])
def test_the_median_curve_takes_the_expected_processor_seconds_within_a_factor_of_five(method):
    variant = Variant("by default", method, {})
    found = []
    for profile in [profile for _, profile in expected_seconds.surfaces(25) if find_method(method).takes(profile)]:
        list(expected_seconds.ratios(variant, profile))  # compiles
        found += [ratio for *_, ratio in expected_seconds.ratios(variant, profile)]
    assert len(found) > 8
    assert 0.2 < np.median(found) < 5, found
