"""The line that a terminal shows, and that nothing else does."""

import io
import sys
import time

import pytest

from weier.kernels.loads_done import count_load
from weier.pipeline import progress
from weier.pipeline.progress import ERASE, waiting


class Terminal(io.StringIO):
    """What is written to a terminal."""

    def isatty(self):
        """It is one."""
        return True


@pytest.fixture
def soon(monkeypatch):
    monkeypatch.setattr(progress, "QUIET", 0.1)


def test_a_terminal_shows_what_is_computed_and_for_how_long(soon, monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    with waiting("solving by bem", 12.0):
        while "solving" not in screen.getvalue():
            time.sleep(0.01)
    assert screen.getvalue().startswith(f"{ERASE}solving by bem: ")
    assert " s of up to 12 s" in screen.getvalue()
    assert screen.getvalue().endswith(ERASE)


def test_a_terminal_shows_the_loads_done_of_all(soon, monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    with waiting("solving by bem", loads=40):
        count_load()
        count_load()
        while "loads" not in screen.getvalue():
            time.sleep(0.01)
    assert "solving by bem: 2 of 40 loads, " in screen.getvalue()


@pytest.mark.parametrize("stream", [io.StringIO, Terminal])
def test_a_log_shows_nothing_and_neither_does_what_is_short(stream, monkeypatch):
    screen = stream()
    monkeypatch.setattr(sys, "stderr", screen)
    with waiting("solving by bem"):
        pass
    assert screen.getvalue() == ""
