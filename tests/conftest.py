"""Fixtures that several test files ask for."""

import signal

import pytest


@pytest.fixture
def ctrl_c():
    """What a terminal would have: programs in the background of a script are told to ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
