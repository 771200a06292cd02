"""Which curves are the same, so that a list solves them once."""

import numpy as np

import weier
from weier.api.task import CurveTask

LOADS = np.array([0.01, 0.1, 1.0])
SERIES = [weier.Profile(1.25, 5, 2, seed=seed) for seed in (1, 2)]


def test_curves_are_the_same_if_only_unused_phases_differ():
    one = CurveTask(SERIES[0], "layer", {"points": 8}, LOADS)
    others = [
        one._replace(method="archard", settings={}),
        one._replace(settings={"points": 9}),
        one._replace(loads=LOADS[1:]),
        one._replace(profile=weier.Profile(1.25, 5, 3)),
    ]
    assert one.series == one._replace(profile=SERIES[1]).series
    assert len({curve.series for curve in (one, *others)}) == 5
    assert CurveTask(SERIES[0], "patches", {}, LOADS).series is None


def test_a_list_solves_these_once_and_all_others():
    found = weier.solve([*SERIES, SERIES[0]], LOADS, ["layer", "demelio", "bem"], layer={"points": 8})
    assert [len({*seconds}) for seconds in found.seconds.values.T] == [1, 1, 3]
    assert np.isfinite(found.compliance).all()
