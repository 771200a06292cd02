"""Fixtures of several test files, and the order in which files run, some in parallel."""

import signal

import pytest

# A minute each, so that no process is idle at the end. The first compiles kernels while the second runs programs.
LONGEST = ("test_docs.py", "test_pipeline.py", "test_faults.py")


def pytest_collection_modifyitems(items):
    """The longest files first."""
    items.sort(key=lambda item: LONGEST.index(item.path.name) if item.path.name in LONGEST else len(LONGEST))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Each process of `pytest -n` takes whole files, in their order: fixtures of a file are made once."""
    from xdist.scheduler import LoadFileScheduling

    config.option.loadscopereorder = False
    return LoadFileScheduling(config, log)


@pytest.fixture(autouse=True)
def first_attempts(request, monkeypatch):
    """No load of contact patches takes a second attempt, which would hide that the first one has failed."""
    if request.node.get_closest_marker("second_attempt"):
        return
    from weier.methods.patches import solver  # here, since tests of the pipeline import no solver

    solve = solver.solve_in_stages

    def once(surface, guess, tolerance, accepted):
        if guess.attempts > 1:
            pytest.fail(f"a second attempt under {guess.load!r} p_0*: mark the test with second_attempt if it may")
        return solve(surface, guess, tolerance, accepted)

    monkeypatch.setattr(solver, "solve_in_stages", once)


@pytest.fixture
def ctrl_c():
    """What a terminal would have: programs in the background of a script ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
