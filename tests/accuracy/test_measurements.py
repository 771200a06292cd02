"""Seconds and errors on usual series, and what parts of weier cost."""

import numpy as np

from weier.accuracy import costs, expected_seconds, random_series
from weier.methods.registry import find_method


def test_the_trade_has_bounds_where_a_method_states_them():
    case = random_series.random_case(np.random.default_rng(0))
    assert case.loads[-1] < case.profile.full_contact_load
    layer, elements, patches = (
        random_series.row(method, [random_series.measure(case, method, {}, 1)])
        for method in ("layer", "bem", "patches")
    )
    assert len(layer) == len(elements) == len(random_series.HEADER)
    assert layer[3:5] == ["", ""]
    assert 0 < float(elements[4]) <= 1
    assert float(patches[4]) <= 1
    assert {name for name, _ in random_series.METHODS.values()} == {"archard", "demelio", "layer", "bem", "patches"}


def test_every_part_has_a_row(monkeypatch):
    monkeypatch.setattr(costs, "REPEATS", 1)
    rows = [*costs.estimates(3, 50), *costs.layers(4), *costs.batches(2)]
    assert len({what for what, _ in rows}) == len(rows) == 2 * 2 * 3 + 3 + 1
    assert not any("nan" in measured or "inf" in measured for _, measured in rows)


def test_expected_seconds_stand_beside_those_of_few_waves():
    surfaces = list(expected_seconds.surfaces(100))
    assert [profile.waves_per_period[-1] for _, profile in surfaces] == [25, 64, 81, 100, 100]
    name, waves, method, seconds, ratio = expected_seconds.row(*surfaces[0], find_method("bem"))
    assert (name, waves, method) == ("D = 1.25, gamma = 5, m = 3", "25", "bem")
    assert all(float(value) >= 0 for value in seconds.split(" / "))
    assert float(ratio) > 0
