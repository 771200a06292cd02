"""Progress of a solution: the number of loads done, and the remaining time."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from weier.kernels.jit import COMPILING_SECONDS

ERASE = "\r\033[K"  # This escape sequence clears the line of a terminal.
TERMINAL_SECONDS, LOG_SECONDS = 0.5, 5.0  # Intervals between two messages: a log keeps all of them.


def clock() -> float:
    """Seconds from an arbitrary start, without those of compiling."""
    return perf_counter() - COMPILING_SECONDS.get()


class Loads:
    """A counter of the loads of successive curves; each call counts one load."""

    def __init__(self, per_curve: int, add: Callable[[int], object]) -> None:
        """A curve has `per_curve` loads; `add` is called with the number of loads that are done."""
        self.per_curve, self.add, self.done = per_curve, add, 0

    def __call__(self) -> None:
        """Count one load of this curve, unless all are counted, since a method may solve some twice."""
        if self.done < self.per_curve:
            self.done += 1
            self.add(1)

    def end_curve(self) -> None:
        """Count the remaining loads of this curve: closed forms do not count any themselves."""
        rest, self.done = self.per_curve - self.done, 0
        self.add(rest)


class Progress:
    """Messages at intervals with the number of loads of all curves that are done."""

    def __init__(self, total: int, pause: float, say: Callable[[str], None]) -> None:
        """For `total` loads, with `pause` seconds between two messages to `say`."""
        self.total, self.pause, self.say, self.done = total, pause, say, 0
        self.start = self.said = perf_counter()

    def add(self, number: int) -> None:
        """Count further loads, and issue a message if the interval has passed."""
        self.done, now = self.done + number, perf_counter()
        if now - self.said > self.pause and 0 < self.done < self.total:
            self.said = now
            left = (now - self.start) * (self.total - self.done) / self.done
            self.say(f"{self.done} of {self.total} loads, about {left:.0f} s left")


@contextmanager
def waiting(what: str) -> Iterator[Callable[[str], None]]:
    """Show on a line of a terminal, if there is one, what is computed; yields a function that shows the progress."""
    terminal = sys.stderr.isatty()

    def show(words: str) -> None:
        if terminal:
            print(ERASE + words, end="", file=sys.stderr, flush=True)

    show(what)
    try:
        yield lambda far: show(f"{what}: {far}")
    finally:
        show("")
