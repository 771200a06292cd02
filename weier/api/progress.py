"""Progress of a solution: the number of loads done and the remaining time."""

from __future__ import annotations

import sys
from collections.abc import Callable
from time import perf_counter

from weier.kernels.jit import TIMERS

LONG = 10.0  # Interval between two messages, and least expected time that is announced, in s.


def clock() -> float:
    """Return the seconds since an arbitrary start, not counting loading and compiling of kernels."""
    return perf_counter() - sum(timer.duration for timer in TIMERS if timer.done)


class Progress:
    """Messages at intervals with the finished part of a whole, such as "400 loads".

    A call counts one of `total` items: a solver that reports to this object calls it after each load.
    """

    def __init__(self, total: float, whole: str, pause: float, say: Callable[[str], None]) -> None:
        """Count up to `total`, with `pause` seconds between two messages to `say`."""
        self.total, self.whole, self.pause, self.say = total, whole, pause, say
        self.done, self.start, self.said = 0.0, clock(), perf_counter()

    def __call__(self) -> None:
        """Count one load."""
        self.reach(self.done + 1)

    def reach(self, done: float) -> None:
        """Set the number of finished items."""
        self.done, now = done, perf_counter()
        if 0 < done < self.total and now - self.said > self.pause:
            self.said, left = now, (clock() - self.start) * (self.total - done) / done
            self.say(f"{100 * done / self.total:.0f} % of {self.whole}, about {left:.0f} s left")


def shown_progress(name: str, total: float, whole: str, expected: float = 0.0) -> Progress:
    """Return a progress that is shown on standard error, by a line every `LONG` seconds.

    If more than `LONG` seconds are expected, they are announced beforehand.
    """

    def say(far: str) -> None:
        print(f"{name}: {far}", file=sys.stderr, flush=True)

    if expected > LONG:
        say(f"about {expected:.0f} s for {whole}; Ctrl-C ends it")
    return Progress(total, whole, LONG, say)


def counted(number: int, item: str) -> str:
    """Return a number of items in words."""
    return f"{number} {item}{'s' * (number != 1)}"
