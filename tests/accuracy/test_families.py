"""The families of hard series, and what is counted of their errors."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

from weier import ConvergenceError, Profile
from weier.accuracy import coverage, families
from weier.accuracy.families import FAMILIES, LOADS, MAX_WAVES
from weier.methods import bem


@pytest.fixture(scope="module")
def one_draw() -> families.Draw:
    profile, loads = Profile(1.3, 2, 2, (0.0, 1.0)), np.array([0.01, 0.3])
    return families.Draw(
        "usual",
        profile,
        loads,
        {"points": 16 * 2},
        *families.solve_exactly(profile, loads),
    )


@pytest.mark.parametrize("family", FAMILIES)
def test_draws_are_series_within_limits(family, monkeypatch):
    """Without their exact curves, and with as many contacts at each load as it has zeros behind the point."""
    monkeypatch.setattr(families, "solve_exactly", lambda profile, loads: (np.zeros((2, loads.size)),) * 2)
    monkeypatch.setattr(families, "_count", lambda profile, load: int(-np.log10(load / profile.full_contact_load)))
    random = np.random.default_rng(0)
    for draw in (families.draw_one(random, family) for _ in range(20)):
        assert draw.profile.waves_per_period[-1] <= MAX_WAVES
        assert 1 <= draw.loads.size <= LOADS
        assert np.all(np.diff(draw.loads) > 0)
        assert draw.loads[0] > 0
        assert bem.checked_points(draw.profile, draw.settings["points"])


def test_an_error_beyond_what_is_stated_is_found(one_draw):
    right = coverage.judge_all(one_draw)
    assert list(right) == ["bem", "bem with staircase", "patches"]
    for judged in right.values():
        assert not np.any(judged.ratio > 1)
    assert list(coverage.exceeded([(one_draw, right)])) == []
    off = 10 * right["bem"].stated[0, 1]
    wrong = one_draw._replace(exact=one_draw.exact + np.array([[0.0, off], [0.0, 0.0]]))
    judged = coverage.judge(wrong, coverage.by_elements)
    (ratio, where), *others = coverage.exceeded([(wrong, {"bem": judged})])
    assert others == []
    assert ratio == pytest.approx(10, abs=1)
    assert f"h by bem is off by {judged.error[0, 1]:.2e}" in where
    assert 'Profile(1.3, "2", 2, [0.0, 1.0]) at 0.3' in where


def test_a_number_is_not_judged_by_a_reference_that_is_no_finer(one_draw):
    coarse = one_draw._replace(uncertainty=np.full((2, 2), 100.0))
    assert all(np.isnan(judged.ratio).all() for judged in coverage.judge_all(coarse).values())


def test_refused_and_unsolved_loads_are_counted(one_draw, monkeypatch):
    def refuse_light_loads(draw, loads):
        if loads[0] < 0.1:
            raise ConvergenceError("too light")
        return bem.curve(draw.profile, loads, **draw.settings)

    monkeypatch.setitem(coverage.METHODS, "bem", refuse_light_loads)
    unsolved = one_draw._replace(exact=np.full((2, 2), np.nan), uncertainty=np.full((2, 2), np.nan))
    found = [(draw, coverage.judge_all(draw, ["bem"])) for draw in (one_draw, unsolved)]
    family, loads, h, R, refused = coverage.row("usual", found, ["bem"])
    assert (family, loads, refused) == ("usual", "4", "2")
    assert h.startswith("0 of 1,")
    assert R.startswith("0 of 1,")


def test_the_table_has_a_row_for_each_family_that_was_drawn(one_draw, monkeypatch):
    monkeypatch.setattr(coverage, "draws", lambda *arguments: iter([one_draw]))
    result = CliRunner().invoke(coverage.main, ["--families", "usual"])
    assert result.exit_code == 0
    rows = [line for line in result.stdout.splitlines() if line.startswith("|")]
    assert [line.split(" | ")[0] for line in rows] == ["| family", "| ---", "| usual", "| all"]
    assert len({line.count("|") for line in rows}) == 1
    result = CliRunner().invoke(coverage.main, ["--methods", "patches, bem"])
    assert "h by patches | R by patches | h by bem | R by bem | no solution" in result.stdout
    for option in ("--families", "--methods"):
        assert CliRunner().invoke(coverage.main, [option, "unknown"]).exit_code == 2
