"""The families of hard series, and what is counted of their errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import families, stated_errors
from benchmarks.families import FAMILIES, LOADS, MAX_WAVES
from weier import ConvergenceError, Profile
from weier.methods import bem


@pytest.fixture(scope="module")
def one_draw() -> families.Draw:
    profile, loads = Profile(1.3, 2, 2, (0.0, 1.0)), np.array([0.01, 0.3])
    return families.Draw("usual", profile, loads, {"points_per_wave": 16}, *families.solve_exactly(profile, loads))


@pytest.mark.parametrize("family", FAMILIES)
def test_draws_are_series_within_limits(family, monkeypatch):
    """Without their exact curves, and with as many contacts at each load as there are digits of it."""
    monkeypatch.setattr(families, "solve_exactly", lambda profile, loads: (np.zeros((2, loads.size)),) * 2)
    monkeypatch.setattr(families, "_count", lambda profile, load: int(-np.log10(load / profile.full_contact_load)))
    random = np.random.default_rng(0)
    for each in (families.draw(random, family) for _ in range(20)):
        assert each.profile.waves_per_period[-1] <= MAX_WAVES
        assert 1 <= each.loads.size <= LOADS
        assert np.all(np.diff(each.loads) > 0)
        assert each.loads[0] > 0


def test_a_file_gives_the_same_draws(one_draw, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(families, "draw", lambda random, family: one_draw)
    first = list(families.draws(tmp_path / "kept", ["usual"], np.random.default_rng(0), 3))
    assert len(first) == 2
    monkeypatch.setattr(families, "draw", None)
    for each in families.draws(tmp_path / "kept", ["usual"], np.random.default_rng(0), 4):
        assert (each.profile, each.settings) == (one_draw.profile, one_draw.settings)
        for name in families.ARRAYS:
            np.testing.assert_array_equal(getattr(each, name), getattr(one_draw, name))
    assert list(families.draws(tmp_path / "kept", ["rational gamma"], np.random.default_rng(0), 0)) == []


def test_an_error_beyond_what_is_stated_is_found(one_draw):
    right = stated_errors.judge(one_draw)
    assert np.all(right.ratio <= 1)
    assert list(stated_errors.exceeded([(one_draw, right)])) == []
    wrong = one_draw._replace(exact=one_draw.exact + np.array([[0.0, 1e-3], [0.0, 0.0]]))
    (ratio, where), *others = stated_errors.exceeded([(wrong, stated_errors.judge(wrong))])
    assert others == []
    assert ratio == pytest.approx(1e-3 / right.stated[0, 1], rel=1e-2)
    assert "h off by 1.00e-03" in where
    assert 'Profile(1.3, "2", 2, [0.0, 1.0]) at 0.3' in where


def test_a_difference_is_not_judged_by_a_reference_that_is_no_finer(one_draw):
    coarse = one_draw._replace(uncertainty=np.ones((2, 2)))
    assert np.isnan(stated_errors.judge(coarse).ratio).all()


def test_refused_and_unsolved_loads_are_counted(one_draw, monkeypatch):
    def refuses_light_loads(profile, loads, **settings):
        if loads[0] < 0.1:
            raise ConvergenceError("too light")
        return bem.curve(profile, loads, **settings)

    monkeypatch.setattr(stated_errors, "bem", type("bem", (), {"curve": staticmethod(refuses_light_loads)}))
    unsolved = one_draw._replace(exact=np.full((2, 2), np.nan), uncertainty=np.full((2, 2), np.nan))
    cells = stated_errors.row("usual", [(each, stated_errors.judge(each)) for each in (one_draw, unsolved)])
    assert (cells[1], cells[-2:]) == ("1", ["2", "1"])


def test_the_table_has_a_row_for_each_family_that_was_drawn(one_draw, monkeypatch):
    monkeypatch.setattr(stated_errors, "draws", lambda *wanted: iter([one_draw]))
    result = CliRunner().invoke(stated_errors.main, ["--families", "usual"])
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert [line.split(" | ")[0] for line in lines] == ["| family", lines[1], "| usual", "| all"]
    assert len({line.count("|") for line in lines}) == 1
    assert CliRunner().invoke(stated_errors.main, ["--families", "unknown"]).exit_code == 2
