"""The one route to a solver, and which curves are the same."""

import numpy as np
import pytest

import weier
from weier.api.task import CurveTask, distinct

LOADS = np.array([0.01, 0.1, 1.0])
SERIES = [weier.Profile(1.25, 5, 2, seed=seed) for seed in (1, 2, 1)]
STEEL = weier.Interface(E_1=2e11, E_2=2e11, nu_1=0.3, nu_2=0.3, rho_1=1e-7, rho_2=1e-7, lambda_0=1e-3, g_0=1e-6)


@pytest.mark.parametrize(
    ("solve", "count"),
    [
        (lambda: weier.solve(SERIES[0], LOADS, "demelio"), 1),
        (lambda: weier.solve(SERIES, LOADS, ["demelio", "patches"]), 1 + 3),
        (lambda: STEEL.solve(SERIES, [1e6, 1e7], ["demelio", "archard"]), 2),
        (lambda: STEEL.solve(SERIES[0], [1e6, 1e7], "demelio"), 1),
        (lambda: weier.find_load(SERIES[0], contact_fraction=0.5), None),
    ],
    ids=["one", "list", "list in SI", "one in SI", "find_load"],
)
def test_every_solution_takes_the_same_route(solve, count, monkeypatch):
    """Its curves are those that are distinct: an ensemble has one of a method without phases."""
    taken, own = [], CurveTask.solve
    monkeypatch.setattr(CurveTask, "solve", lambda curve: taken.append(curve) or own(curve))
    solve()
    assert len(taken) == count or (count is None and len(taken) > 2)
    assert len(distinct(taken)) == len(taken)


def test_curves_are_the_same_if_only_unused_phases_differ():
    one = CurveTask(SERIES[0], "layer", {"points": 8}, LOADS)
    same = one._replace(profile=SERIES[1])
    others = [
        one._replace(method="archard", settings={}),
        one._replace(settings={"points": 9}),
        one._replace(loads=LOADS[1:]),
        one._replace(profile=weier.Profile(1.25, 5, 3)),
        *(CurveTask(profile, "patches", {}, LOADS) for profile in SERIES[:2]),
    ]
    assert distinct([one, same, *others, same]) == [one, *others]
