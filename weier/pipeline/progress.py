"""How far a solve is: the loads done, and the time that is left."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

ERASE = "\r\033[K"  # the line
TERMINAL_SECONDS, LOG_SECONDS = 0.5, 5.0  # between two words


class Loads:
    """The loads of one curve after another: calling it counts one."""

    def __init__(self, each: int, add: Callable[[int], object]) -> None:
        """There are `each` of a curve; `add` takes numbers of them."""
        self.each, self.add, self.done = each, add, 0

    def __call__(self) -> None:
        """One load of this curve more, which may solve some twice."""
        if self.done < self.each:
            self.done += 1
            self.add(1)

    def end_curve(self) -> None:
        """All loads of this curve are done: a closed form counts none."""
        rest, self.done = self.each - self.done, 0
        self.add(rest)


class Progress:
    """Says at times how many loads of all curves are done."""

    def __init__(self, total: int, pause: float, say: Callable[[str], None]) -> None:
        """Of `total` loads, after a pause of some seconds."""
        self.total, self.pause, self.say, self.done = total, pause, say, 0
        self.start = self.said = perf_counter()

    def add(self, number: int) -> None:
        """So many loads more are done: say how many are, if it is time to."""
        self.done, now = self.done + number, perf_counter()
        if now - self.said > self.pause and 0 < self.done < self.total:
            self.said = now
            left = (now - self.start) * (self.total - self.done) / self.done
            self.say(f"{self.done} of {self.total} loads, about {left:.0f} s left")


@contextmanager
def waiting(what: str) -> Iterator[Callable[[str], None]]:
    """Say on a line of a terminal, if there is one, what is computed, and give what adds to it how far it is."""
    terminal = sys.stderr.isatty()

    def show(words: str) -> None:
        if terminal:
            print(ERASE + words, end="", file=sys.stderr, flush=True)

    show(what)
    try:
        yield lambda far: show(f"{what}: {far}")
    finally:
        show("")
