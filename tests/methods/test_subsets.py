"""The value and error of a load do not depend on the other loads: all methods, on random subsets of loads."""

import math

import numpy as np
import pytest

from weier import Profile, random_phases, solve
from weier.methods import registry
from weier.methods.hybrid import newton

COARSE = Profile(1.25, 5, 1)
SHORT = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
LONG = Profile(1.1, 3, math.inf, random_phases(0))
LOADS = np.geomspace(0.1, 10, 23)

NEWTON = 2 * newton.TOLERANCE  # g_0: each load starts from the one before; the slope loses three digits

# Method, profile, settings, and how far two compliances and two resistances may be apart, over the larger of
# themselves and 1; 0 is bit for bit.
CASES = [
    ("westergaard", COARSE, {}, 0.0, 0.0),
    ("archard", SHORT, {}, 0.0, 0.0),
    ("archard", LONG, {}, 0.0, 0.0),
    ("demelio", SHORT, {}, 0.0, 0.0),
    ("demelio", LONG, {}, 0.0, 0.0),
    ("persson", SHORT, {}, 0.0, 0.0),
    ("cascade", SHORT, {}, 0.0, 0.0),
    ("layer", SHORT, {}, 0.0, 0.0),
    ("layer", LONG, {}, 0.0, 0.0),
    ("hybrid", LONG, {"terms": 2}, NEWTON, 1e3 * NEWTON),
    ("bem", SHORT, {}, 0.0, 0.0),
    ("patches", SHORT, {}, 0.0, 0.0),
    ("patches", Profile(1.5, 3, 3, math.pi), {"contact_edges": True}, 0.0, 0.0),
    ("patches", Profile(1.75, "5/2", 3, 2.0), {}, 0.0, 0.0),
    ("auto", SHORT, {"tolerance": 1e-2}, 0.0, 0.0),
    ("auto", SHORT, {"tolerance": 3e-2, "quantity": "resistance"}, 0.0, 0.0),
    ("auto", LONG, {"tolerance": 0.02}, 0.0, 0.0),
]


def subsets(count):
    """Random loads of all: a single one, a few, most of them."""
    random = np.random.default_rng(5)
    for size in (1, 1, 2, 5, count - 1):
        yield np.sort(random.choice(count, size, replace=False))


def test_every_method_is_here():
    assert {method for method, *_ in CASES} == set(registry.names())


@pytest.mark.parametrize(("method", "profile", "settings", "of_compliance", "of_resistance"), CASES)
def test_the_numbers_of_a_load_do_not_depend_on_the_others(method, profile, settings, of_compliance, of_resistance):
    together = solve(profile, LOADS, method, **settings)
    limits = {"compliance": of_compliance, "resistance": of_resistance}
    if not registry.find_method(method).stiffness:
        limits = {"contact_fraction": 0.0}
    for some in subsets(LOADS.size):
        alone = solve(profile, LOADS[some], method, **settings)
        for quantity, limit in limits.items():
            bound_by_all_loads = {"resistance_error"} if method in ("bem", "auto") else set()
            for name in {quantity, f"{quantity}_error"} & set(together.data_vars) - bound_by_all_loads:
                one, other = alone[name].values, together[name].values[some]
                assert np.all(np.abs(one - other) <= limit * np.maximum(np.abs(other), 1)), (name, one - other)
        if "patch_count" in together:
            name = "patch_count"
            np.testing.assert_array_equal(alone[name].values, together[name].values[some])
        if "contact_edge" in together:
            edges = [curve.contact_edge.values for curve in (alone, together.isel(mean_pressure=some))]
            np.testing.assert_array_equal(*(curve[np.isfinite(curve)] for curve in edges))
