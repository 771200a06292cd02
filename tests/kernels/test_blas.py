"""Small matrices are solved on one thread, and the process gets its threads back."""

from importlib import import_module

import numpy as np
import pytest
from threadpoolctl import OpenBLASController, threadpool_info, threadpool_limits

import weier
from weier.methods.patches import given_edges

LOADS = np.array([0.05, 0.5])


def threads() -> set[int]:
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@pytest.fixture(autouse=True)
def two_threads():
    import_module("scipy.linalg")  # loads a BLAS of its own, whose threads are counted, too
    before = threadpool_limits(limits=2, user_api="blas")
    OpenBLASController.clear_controlling_thread(force=True)
    yield
    before.restore_original_limits()
    OpenBLASController.clear_controlling_thread(force=True)


def test_the_dense_solver_takes_one(monkeypatch):
    seen, real = [], given_edges._close

    def watched(*given):
        seen.append(threads())
        return real(*given)

    monkeypatch.setattr(given_edges, "_close", watched)
    weier.solve(weier.Profile(D=1.25, gamma=5, m=1), LOADS, "patches")
    assert seen
    assert all(threads_seen == {1} for threads_seen in seen)
    assert threads() == {2}
