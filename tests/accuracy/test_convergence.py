"""Estimates and bounds of the infinite series by the number of terms resolved."""

import numpy as np
import pytest

from weier import Profile, random_phases
from weier.accuracy import convergence
from weier.methods import bem

LOADS = np.geomspace(3e-3, 3, 7)
PROFILE = Profile(1.25, 2, np.inf, random_phases(2))


@pytest.fixture(scope="module")
def resolved():
    return convergence.measure(PROFILE, LOADS, 6)


def test_estimates_lie_within_all_bounds_and_close_in(resolved):
    assert [one.terms for one in resolved] == [1, 2, 3, 4, 5, 6]
    last = resolved[-1].estimate
    mesh = np.pi**2 / 2 / 32**2  # dx^2/8 times the curvature of one wave, on the grid of the estimate, in g_0
    for one in resolved:
        # The last estimate lies within the bounds of every shorter series: they are about the same infinite one.
        assert np.all((one.low - mesh <= last) & (last <= one.high + mesh))
        assert np.all(one.high <= PROFILE.total_amplitude)
    deviation = [np.abs(one.estimate - last).max() for one in resolved[:-1]]
    assert deviation[-1] < deviation[0] / 3
    # Far better than the certificate, which is half as wide as the bounds.
    assert all(own < 0.75 * (one.high - one.low).max() / 2 for own, one in zip(deviation, resolved, strict=False))


def test_terms_that_take_too_many_points_are_left_out(monkeypatch, capsys):
    monkeypatch.setattr(bem.stated_errors, "MAX_POINTS", 2000)
    found = convergence.measure(Profile(1.25, 5, np.inf, 1.0), LOADS[::3], 5)
    assert [one.terms for one in found] == [1, 2, 3, 4]
    assert "5 terms resolved: " in capsys.readouterr().err


def test_the_table_has_the_errors_of_each_number_of_terms(resolved):
    rows = convergence.rows(PROFILE, resolved)
    assert [row[:3] for row in rows] == [
        ["D = 1.25, gamma = 2, m = inf, seed = 2", str(one.terms), f"{one.nodes:.0f}"] for one in resolved
    ]
    widths = [np.max(one.high - one.low) / 2 for one in resolved]
    assert [float(row[3]) for row in rows] == pytest.approx(widths, rel=0.05)
    distances = [np.max(np.abs(one.estimate - resolved[-1].estimate)) for one in resolved[:-1]]
    assert [float(row[4]) for row in rows[:-1]] == pytest.approx(distances, rel=0.05)
    assert rows[-1][4] == ""  # the error of the last estimate is not known
