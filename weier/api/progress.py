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
    """Messages at intervals with the finished part of a whole, such as "400 loads", and a limit of the time.

    A call counts one of `total` items: a solver that reports to this object calls it after each load.
    """

    def __init__(
        self, total: float, whole: str, pause: float, say: Callable[[str], None], max_seconds: float | None = None
    ) -> None:
        """Count up to `total`, with `pause` seconds between two messages to `say`."""
        self.total, self.whole, self.pause, self.say, self.max_seconds = total, whole, pause, say, max_seconds
        self.done, self.start, self.said = 0.0, perf_counter(), perf_counter()

    def __call__(self) -> None:
        """Count one load."""
        self.reach(self.done + 1)

    def reach(self, done: float) -> None:
        """Set the number of finished items; TimeoutError if others remain after the limit of the time."""
        self.done, now = done, perf_counter()
        if not 0 < done < self.total:
            return
        far = f"{100 * done / self.total:.0f} % of {self.whole}"
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
    name: str, total: float, whole: str, max_seconds: float | None = None, expected: float = 0.0
) -> Iterator[Progress]:
    """Show the progress on standard error: in one line of a terminal, or in a log by a line every `LONG` seconds.

    If more than `LONG` seconds are expected, they are announced beforehand.
    """
    terminal = sys.stderr.isatty()

    def say(far: str) -> None:
        start, end = (ERASE, "") if terminal else ("", "\n")
        print(f"{start}{name}: {far}", end=end, file=sys.stderr, flush=True)

    if expected > LONG:
        say(f"about {expected:.0f} s for {whole}; Ctrl-C ends it")
    try:
        yield Progress(total, whole, TERMINAL_SECONDS if terminal else LONG, say, max_seconds)
    finally:
        if terminal:
            print(ERASE, end="", file=sys.stderr, flush=True)


def counted(number: int, item: str) -> str:
    """Return a number of items in words."""
    return f"{number} {item}{'s' * (number != 1)}"
