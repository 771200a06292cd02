"""The families of hard series, and what is counted of their errors."""

from __future__ import annotations

import numpy as np
import pytest

from weier import Profile
from weier.accuracy import coverage, families
from weier.accuracy.families import VARIANTS
from weier.accuracy.reference import contact_reference
from weier.accuracy.runner import Variant


@pytest.fixture(scope="module")
def one_draw() -> families.Draw:
    grid = {"points_per_wave": 16}
    settings = grid, grid | {"staircase": "kept"}, {"tolerance": 1e-6}
    variants = {name: Variant(name.split()[0], own) for name, own in zip(VARIANTS, settings, strict=True)}
    return families.Draw("usual", Profile(1.3, 2, 2, (0.0, 1.0)), np.array([0.01, 0.3]), variants)


@pytest.fixture
def reference(monkeypatch):
    """Replace a part of the reference of all draws."""

    def replace(**parts):
        def changed(profile, loads):
            right = contact_reference(profile, loads)
            return right._replace(**{name: change(getattr(right, name)) for name, change in parts.items()})

        monkeypatch.setattr(coverage, "contact_reference", changed)

    return replace


def test_an_error_beyond_what_is_stated_is_found(one_draw, reference):
    right = [coverage.judge(one_draw, name) for name in VARIANTS]
    assert not any(list(coverage.exceeded(one)) for one in right)
    off = 10 * right[0].stated[0, 1]
    reference(values=lambda exact: exact + np.array([[0, off], [0, 0]]))
    judged = coverage.judge(one_draw, "bem")
    (where,) = coverage.exceeded(judged)
    assert judged.ratio[0, 1] == pytest.approx(10, abs=1)
    assert f"h by bem is off by {judged.error[0, 1]:.2e}" in where
    assert f"{one_draw.profile!r} at 0.3" in where


def test_a_number_is_not_judged_by_a_reference_that_is_no_finer(one_draw, reference):
    reference(uncertainty=lambda known: known + 100.0)
    assert all(np.isnan(coverage.judge(one_draw, name).ratio).all() for name in VARIANTS)
