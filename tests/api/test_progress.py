"""How far a solve is: said for each load that is done, and on a terminal alone by commands of one profile."""

import io
import sys

import numpy as np
import pytest

from weier.api import progress
from weier.api.progress import ERASE, Loads, Progress, waiting
from weier.methods.load_progress import count_load, reporting_to
from weier.methods.registry import find_method
from weier.surface.profile import Profile

LOADS = np.array([0.1, 0.3, 1.0])
TWO_WAVES = Profile(D=1.25, gamma=2, m=2)


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("bem", {"points_per_wave": 16}),
        ("bem", {"points_per_wave": 16, "staircase": "kept"}),
        ("patches", {}),
    ],
)
def test_each_load_counts_once(name, settings):
    """Not what a load starts from, either, and not what bounds the truncated terms."""
    counted = []
    with reporting_to(lambda: counted.append(1)):
        find_method(name).solve(TWO_WAVES, LOADS, **settings)
    assert len(counted) == LOADS.size


def test_loads_of_another_solution_are_not_counted():
    counted = []
    with reporting_to(lambda: counted.append(1)):
        with reporting_to():
            count_load()
        count_load()
    count_load()
    assert len(counted) == 1


def test_progress_has_the_loads_and_the_remaining_time(monkeypatch):
    said, clock = [], iter(range(0, 100, 4))
    monkeypatch.setattr(progress, "perf_counter", lambda: next(clock))
    loads = Loads(10, Progress(30, 3.0, said.append).add)
    loads()
    loads.end_curve()  # of a method that counts not all
    for _ in range(12):
        loads()
    loads.end_curve()
    loads.end_curve()
    assert said[:2] == ["1 of 30 loads, about 116 s left", "10 of 30 loads, about 16 s left"]
    assert said[-1] == "20 of 30 loads, about 26 s left"  # and nothing at the end


@pytest.mark.parametrize(
    ("terminal", "said"), [(True, f"{ERASE}solving by bem{ERASE}solving by bem: 2 of 40 loads{ERASE}"), (False, "")]
)
def test_a_terminal_shows_what_is_computed_and_how_far_it_is_and_a_log_does_not(monkeypatch, terminal, said):
    screen = io.StringIO()
    screen.isatty = lambda: terminal
    monkeypatch.setattr(sys, "stderr", screen)
    with waiting("solving by bem") as show:
        show("2 of 40 loads")
    assert screen.getvalue() == said
