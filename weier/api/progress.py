"""Progress of a solution: the number of loads done, the remaining time, and a limit of the time."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from weier.kernels.jit import COMPILING_SECONDS

ERASE = "\r\033[K"  # This escape sequence clears the line of a terminal.
TERMINAL_SECONDS, LONG = 0.5, 10.0  # Intervals between two messages, on a terminal and in a log.


def clock() -> float:
    """Return the seconds since an arbitrary start, not counting compilation."""
    return perf_counter() - COMPILING_SECONDS.get()


class Progress:
    """Messages at intervals with the number of finished loads, or other items, and a limit of the time.

    A call counts one load: a solver that reports to this object calls it after each load.
    """

    def __init__(
        self,
        total: float,
        pause: float,
        say: Callable[[str], None],
        things: str = "loads",
        max_seconds: float | None = None,
    ) -> None:
        """Count up to `total`, with `pause` seconds between two messages to `say`."""
        self.total, self.pause, self.say, self.things, self.max_seconds = total, pause, say, things, max_seconds
        self.done, self.start, self.said = 0.0, perf_counter(), perf_counter()

    def __call__(self) -> None:
        """Count one load."""
        self.reach(self.done + 1)

    def reach(self, done: float) -> None:
        """Set the number of finished items; TimeoutError if others remain after the limit of the time."""
        self.done, now = done, perf_counter()
        if not 0 < done < self.total:
            return
        counted = f"{done:.0%}" if self.total == 1 else f"{done:.0f} of {self.total:.0f}"
        far = f"{counted} {self.things}"
        if self.max_seconds is not None and now - self.start > self.max_seconds:
            raise TimeoutError(
                f"max_seconds = {self.max_seconds:g} ended the solution after {far}: raise it, or take fewer "
                "loads or a larger tolerance"
            )
        if now - self.said > self.pause:
            self.said = now
            self.say(f"{far}, about {(now - self.start) * (self.total - done) / done:.0f} s left")


@contextmanager
def showing(
    name: str, total: float, things: str = "loads", max_seconds: float | None = None, expected: float = 0.0
) -> Iterator[Progress]:
    """Show the progress on standard error: in one line of a terminal, or in a log by a line every `LONG` seconds.

    If more than `LONG` seconds are expected, they are announced beforehand.
    """
    terminal = sys.stderr.isatty()

    def say(far: str) -> None:
        start, end = (ERASE, "") if terminal else ("", "\n")
        print(f"{start}{name}: {far}", end=end, file=sys.stderr, flush=True)

    if expected > LONG:
        say(f"{total:.0f} {things} take about {expected:.0f} s; Ctrl-C ends it")
    try:
        yield Progress(total, TERMINAL_SECONDS if terminal else LONG, say, things, max_seconds)
    finally:
        if terminal:
            print(ERASE, end="", file=sys.stderr, flush=True)
