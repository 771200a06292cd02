"""How far a solve is: the loads done, and the time that is left."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

ERASE = "\r\033[K"  # the line
TERMINAL_SECONDS, LOG_SECONDS = 0.5, 5.0  # between two words


class Loads:
    """Loads of several curves: calling it counts one, and at times says how many there are."""

    def __init__(self, total: int, each: int, pause: float, say: Callable[[str], None]) -> None:
        """Of `total` loads, `each` of a curve; say so after a pause of some seconds."""
        self.total, self.each, self.pause, self.say = total, each, pause, say
        self.done, self.end = 0, each  # loads, and how many of them there are when this curve is done
        self.start = self.told = perf_counter()

    def __call__(self) -> None:
        """One load more: a curve may solve some twice."""
        self.done = min(self.done + 1, self.end)
        self.tell()

    def end_curve(self) -> None:
        """All loads of a curve are done: a closed form counts none."""
        self.done, self.end = self.end, self.end + self.each
        self.tell()

    def tell(self) -> None:
        """Say how far it is, if it is time to."""
        now = perf_counter()
        if now - self.told > self.pause and self.done < self.total:
            self.told = now
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
