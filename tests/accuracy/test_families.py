"""Coverage: what is counted of the errors on families of hard series."""

from __future__ import annotations

import numpy as np
import pytest

from weier.accuracy import comparison, coverage
from weier.accuracy.families import FAMILIES, VARIANTS, draws
from weier.accuracy.reference import contact_reference


@pytest.fixture(scope="module")
def drawn():
    return next(draws(FAMILIES, VARIANTS, np.random.default_rng(1), 1))


@pytest.fixture
def compared(drawn, monkeypatch):
    """Compare a draw with a reference of which a part is replaced."""

    def compare(**parts):
        def changed(profile, loads):
            right = contact_reference(profile, loads)
            return right._replace(**{name: change(getattr(right, name)) for name, change in parts.items()})

        monkeypatch.setattr(comparison, "contact_reference", changed)
        return list(comparison.compare([drawn]))

    return compare


def test_an_error_beyond_what_is_stated_is_found(drawn, compared):
    right = compared()
    (table,) = coverage.parts(right)
    assert [row.split(" | ")[0] for row in table.splitlines()[2:]] == ["| usual", "| all"]
    off = np.zeros((2, drawn.loads.size))
    off[0, 1] = 10 * right[0].result.stated[0, 1]
    bem, *_ = compared(values=lambda exact: exact + off)
    assert bem.ratio[0, 1] == pytest.approx(10, abs=1)
    (where,) = bem.exceeded()
    assert f"h by bem is off by {bem.error[0, 1]:.2e}" in where
    assert f"{drawn.profile!r} at {drawn.loads[1]}" in where
    assert coverage._coverage([bem]).startswith(f"h: 1 of {drawn.loads.size}, ")


def test_a_number_is_not_judged_by_a_reference_that_is_no_finer(compared):
    assert all(np.isnan(one.ratio).all() for one in compared(uncertainty=lambda known: known + 1e30))
