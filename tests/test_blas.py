"""Small matrices are solved on one thread, and the process gets its threads back."""

from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import weier
from weier import batch, scene
from weier.bem import direct
from weier.blas import one_thread
from weier.patches import newton

LOADS = np.array([0.05, 0.5])


def threads() -> set[int]:
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@pytest.fixture(autouse=True)
def two_threads():
    with threadpool_limits(limits=2, user_api="blas"):
        yield


def test_one_thread_inside_and_what_there_was_outside():
    assert threads() == {2}
    with one_thread():
        assert threads() == {1}
    assert threads() == {2}


@pytest.mark.parametrize(
    ("place", "name", "method", "settings"),
    [(newton, "assemble", "patches", {}), (direct, "_on_contact", "bem", {"points": 24, "solver": "direct"})],
)
def test_the_dense_solvers_take_one(monkeypatch, place, name, method, settings):
    seen, real = [], getattr(place, name)

    def watched(*given):
        seen.append(threads())
        return real(*given)

    monkeypatch.setattr(place, name, watched)
    weier.solve(weier.Profile(D=1.25, gamma=5, m=1), LOADS, method, **settings)
    assert seen
    assert all(each == {1} for each in seen)
    assert threads() == {2}


def test_a_batch_takes_one_before_its_cases_do(monkeypatch):
    # Else the first case to end would give the others the two that it found.
    seen, real = [], batch.answer

    def watched(*given):
        seen.append(threads())
        return real(*given)

    monkeypatch.setattr(batch, "answer", watched)
    loaded = scene.load(Path(__file__).parents[1] / "config" / "scenes" / "minimal.yaml")
    batch.solve_batch(loaded, loaded.studies["two_waves"], threads=2)
    assert seen == [{1}] * 3
    assert threads() == {2}
