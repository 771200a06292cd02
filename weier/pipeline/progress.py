"""What a terminal shows while something is computed that takes long."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter

from weier.kernels.loads_done import loads_done

QUIET = 2.0  # seconds without a word
ERASE = "\r\033[K"  # the line


@contextmanager
def waiting(what: str, expected: float = 0.0, loads: int = 0) -> Iterator[None]:
    """Say what is computed, how far it is and since when, on one line of a terminal; nothing where there is none.

    Parameters
    ----------
    what : str
        In a few words.
    expected : float
        Seconds that it takes at most, if they are known.
    loads : int
        Of all curves that are computed.
    """
    if not sys.stderr.isatty():
        yield
        return
    ended, start, before = Event(), perf_counter(), loads_done()
    limit = f" of up to {expected:.0f} s" if expected > QUIET else ""

    def show() -> None:
        while not ended.wait(0.5):
            seconds = perf_counter() - start
            if seconds > QUIET:
                done = min(loads_done() - before, loads)  # a plan that is made again solves some twice
                far = f"{done} of {loads} loads, " if done else ""
                print(f"{ERASE}{what}: {far}{seconds:.0f} s{limit}", end="", file=sys.stderr, flush=True)

    thread = Thread(target=show, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
        if perf_counter() - start > QUIET:
            print(ERASE, end="", file=sys.stderr, flush=True)
