"""Seconds over those expected."""

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import expected_seconds
from weier.accuracy.variants import Variant


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
def test_expected_seconds_are_right_within_orders_of_magnitude(method, tmp_path):
    """Within a factor of five on an idle machine, which no test can ask for."""
    command = ["--methods", method, "--most", "3", "--output", str(tmp_path / "page.md")]
    found = CliRunner().invoke(expected_seconds.main, command)
    assert found.exit_code == 0, found.output
    cells = [line.split("|")[-2].split(" to ") for line in found.output.splitlines() if line.startswith("|")][2:]
    assert all(0.01 < float(end) < 100 for ends in cells for end in ends)
