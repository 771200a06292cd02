"""The value and error of a load do not depend on the other loads: all methods, on random subsets of loads."""

import math

import numpy as np
import pytest

from weier import Profile, random_phases, solve
from weier.methods import registry

COARSE = Profile(1.25, 5, 1)
SHORT = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
LONG = Profile(1.1, 3, math.inf, random_phases(0))
LOADS = np.geomspace(0.1, 10, 12)

# Method, profile and settings: all numbers of a load agree bit for bit.
CASES = [
    ("westergaard", COARSE, {}),
    ("archard", SHORT, {}),
    ("archard", LONG, {}),
    ("demelio", SHORT, {}),
    ("demelio", LONG, {}),
    ("persson", SHORT, {}),
    ("cascade", SHORT, {}),
    ("layer", SHORT, {}),
    ("layer", LONG, {}),
    ("bem", SHORT, {}),
    ("patches", SHORT, {}),
    ("patches", Profile(1.5, 3, 3, math.pi), {"contact_edges": True}),
    ("patches", Profile(1.75, "5/2", 3, 2.0), {}),
    ("auto", SHORT, {"tolerance": 1e-2}),
    ("auto", SHORT, {"tolerance": 3e-2, "quantity": "resistance"}),
    ("auto", LONG, {"tolerance": 0.02}),
]


def subsets(count):
    """Random loads of all: a single one, a few, most of them."""
    random = np.random.default_rng(5)
    for size in (1, 5, count - 1):
        yield np.sort(random.choice(count, size, replace=False))


def test_every_method_is_here():
    assert {method for method, *_ in CASES} == set(registry.names())


@pytest.mark.parametrize(("method", "profile", "settings"), CASES)
def test_the_numbers_of_a_load_do_not_depend_on_the_others(method, profile, settings):
    together = solve(profile, LOADS, method, **settings)
    names = {"compliance", "resistance", "compliance_error", "resistance_error", "patch_count", "contact_fraction"}
    names -= {"resistance_error"} if method in ("bem", "auto") else set()  # a bound by all loads
    for some in subsets(LOADS.size):
        alone = solve(profile, LOADS[some], method, **settings)
        for name in names & set(together.data_vars):
            np.testing.assert_array_equal(alone[name].values, together[name].values[some], name)
        if "contact_edge" in together:
            edges = [curve.contact_edge.values for curve in (alone, together.isel(mean_pressure=some))]
            np.testing.assert_array_equal(*(curve[np.isfinite(curve)] for curve in edges))
