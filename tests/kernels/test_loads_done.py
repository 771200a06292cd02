"""Loads are counted as they are solved, by kernels and by Python code."""

import math
from contextlib import suppress

import numpy as np
import pytest

from weier.kernels.loads_done import count_load, counted_as, loads_done
from weier.methods.errors import ConvergenceError
from weier.methods.registry import METHODS, PLANNED, find_method
from weier.methods.solve import solve_checked
from weier.theory.profile import Profile

LOADS = np.array([0.1, 0.3, 1.0])
TWO_WAVES = Profile(D=1.25, gamma=2, m=2)
INFINITE = Profile(D=1.02, gamma=10, m=math.inf)


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("bem", {"points": 32}),
        ("bem", {"points": 32, "solver": "direct"}),
        ("bem", {"points": 32, "edges": "subgrid"}),
        ("hybrid", {"terms": 1}),
        ("patches", {}),
    ],
)
def test_each_load_counts_once(name, settings):
    """Not what a load starts from, either, and not what bounds the truncated terms."""
    before = loads_done()
    find_method(name).solve(INFINITE if name == "hybrid" else TWO_WAVES, LOADS, **settings)
    assert loads_done() - before == LOADS.size


@pytest.mark.parametrize("name", [method.name for method in METHODS if method.takes(TWO_WAVES)])
def test_a_curve_counts_as_its_loads_in_the_end(name):
    """Also of a closed form, which counts nothing, and of a plan, which may solve loads beside those asked for."""
    before = loads_done()
    solve_checked(TWO_WAVES, LOADS, find_method(name), {"tolerance": 1e-2} if name == PLANNED else {})
    assert loads_done() - before == LOADS.size


def test_what_fails_within_a_load_does_not_count_either():
    before = loads_done()
    with suppress(ConvergenceError), counted_as(0):
        count_load()
        raise ConvergenceError("the first load is done")
    assert loads_done() == before
