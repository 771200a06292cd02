"""Marks that tests of several folders bear."""

import os

import pytest
from hypothesis import HealthCheck, settings

# Where a developer sets it, to follow kernels line by line; the gate does not, and runs these tests.
compiled = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"), reason="NUMBA_DISABLE_JIT is set: nothing is compiled"
)


def few(count: int) -> settings:
    """The same examples of hypothesis in each run, so many."""
    return settings(max_examples=count, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


def examples(count: int, many: int) -> pytest.MarkDecorator:
    """A test of a few examples and, where slow tests run, of many others: `how_many` says it to hypothesis."""
    others = settings(few(many), derandomize=False, database=None)
    return pytest.mark.parametrize(
        "how_many", [few(count), pytest.param(others, marks=pytest.mark.slow)], ids=["few", "many"]
    )
