"""What a terminal shows while something is computed that takes long."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter

QUIET = 2.0  # seconds without a word
ERASE = "\r\033[K"  # the line


@contextmanager
def waiting(what: str, expected: float = 0.0) -> Iterator[None]:
    """Say what is computed and for how long already, on one line of a terminal; nothing where the output is none.

    Parameters
    ----------
    what : str
        In a few words.
    expected : float
        Seconds that it takes at most, if they are known.
    """
    if not sys.stderr.isatty():
        yield
        return
    ended, start = Event(), perf_counter()
    limit = f" of up to {expected:.0f} s" if expected > QUIET else ""

    def show() -> None:
        while not ended.wait(0.5):
            seconds = perf_counter() - start
            if seconds > QUIET:
                print(f"{ERASE}{what}: {seconds:.0f} s{limit}", end="", file=sys.stderr, flush=True)

    thread = Thread(target=show, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
        if perf_counter() - start > QUIET:
            print(ERASE, end="", file=sys.stderr, flush=True)
