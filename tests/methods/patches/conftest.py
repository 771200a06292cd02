"""Formulations, periods and waves: a test that takes one of them runs for each."""

import pytest

from tests.methods.patches.westergaard_states import WAVES


@pytest.fixture(params=[False, True])
def dual(request):
    """Whether the segments are gaps."""
    return request.param


@pytest.fixture(params=[1.0, 9.0])
def period(request):
    """A length of the period."""
    return request.param


@pytest.fixture(params=WAVES)
def wave(request):
    """Westergaard's solution with a narrow, wide or very wide contact."""
    return request.param
