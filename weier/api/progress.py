"""Progress of a solution: the number of loads done, and the remaining time."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from weier.data.markdown import significant
from weier.kernels.jit import COMPILING_SECONDS
from weier.methods.load_progress import INTERRUPTIONS, reporting_to

ERASE = "\r\033[K"  # This escape sequence clears the line of a terminal.
LONG = 10.0  # A solution that takes longer, in seconds, is announced.
TERMINAL_SECONDS, LOG_SECONDS = 0.5, 5.0  # Intervals between two messages: a log keeps all of them.


def clock() -> float:
    """Return the seconds since an arbitrary start, not counting compilation."""
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
    """Messages at intervals with the number of finished loads, or other items."""

    def __init__(self, total: int, pause: float, say: Callable[[str], None], things: str = "loads") -> None:
        """Count up to `total`, with `pause` seconds between two messages to `say`."""
        self.total, self.pause, self.say, self.things, self.done = total, pause, say, things, 0
        self.start = self.said = perf_counter()

    def add(self, number: int) -> None:
        """Count further ones, and issue a message if the interval has passed."""
        self.done, now = self.done + number, perf_counter()
        if now - self.said > self.pause and 0 < self.done < self.total:
            self.said = now
            left = (now - self.start) * (self.total - self.done) / self.done
            self.say(f"{self.done} of {self.total} {self.things}, about {left:.0f} s left")


class Announcement:
    """Announces once, in a sentence, that something takes long, and then shows its progress on a terminal."""

    def __init__(self, name: str, advice: str = "") -> None:
        """Take the name of the call, and the advice that ends the sentence."""
        self.name, self.advice, self.announced = name, advice, False
        self.start, self.said = clock(), perf_counter()

    def expect(self, what: str, seconds: float) -> None:
        """Announce a task if its expected seconds are many."""
        if seconds > LONG:
            self._announce(f"{what} about {significant(seconds, 2)} s")

    def show(self, share: float, done: str) -> None:
        """Announce the task, or show the completed fraction."""
        now, lasted = perf_counter(), clock() - self.start
        far = f"{done}, about {lasted * (1 / share - 1):.0f} s left"
        if not self.announced and lasted > LONG and share < 1:
            self._announce(far)
        elif self.announced and sys.stderr.isatty() and now - self.said > TERMINAL_SECONDS:
            self.said = now
            print(f"{ERASE}{self.name}: {far}", end="", file=sys.stderr, flush=True)

    def _announce(self, what: str) -> None:
        self.announced = True
        print(f"{self.name}: {what}{self.advice}", file=sys.stderr, flush=True)

    def close(self) -> None:
        """Clear the line of a terminal."""
        if self.announced and sys.stderr.isatty():
            print(ERASE, end="", file=sys.stderr, flush=True)


class Watch(Announcement):
    """Announces a long solution once, reports its progress, and ends it at a time limit.

    It is called after each load, by a solver that reports to it.
    """

    def __init__(self, total: int, expected: float, max_seconds: float | None, silent: bool = False) -> None:
        """Watch `total` loads with these expected seconds; if silent, only enforce the limit."""
        advice = "" if max_seconds else f"; max_seconds would limit {'it' if total == 1 else 'them'}"
        super().__init__("weier.solve", advice)
        self.total, self.max_seconds, self.silent, self.done, self.begun = total, max_seconds, silent, 0, self.said
        self.expect(f"{total} load{' takes' if total == 1 else 's take'}", expected)

    def __call__(self) -> None:
        """Count one load, unless all are counted."""
        self.done = min(self.done + 1, self.total)  # a method may solve some twice
        if self.max_seconds is not None and perf_counter() - self.begun > self.max_seconds:
            raise TimeoutError(
                f"max_seconds = {self.max_seconds:g} ended the solution after {self.done} of {self.total} loads: "
                "raise it, or take fewer loads or a larger tolerance"
            )
        if not self.silent:
            self.show(self.done / self.total, f"{self.done} of {self.total} loads")


@contextmanager
def searching(name: str, expected: float) -> Iterator[Callable[[float], None]]:
    """Announce a long search; yields a function that shows the completed fraction."""
    search = Announcement(name)
    search.expect("the search takes", expected)
    try:
        yield lambda share: search.show(min(max(share, 1e-3), 1.0), f"{share:.0%} of the contact")
    finally:
        search.close()


@contextmanager
def watching(total: int, expected: float, max_seconds: float | None) -> Iterator[None]:
    """In a `with` statement, watch the loads that are solved: see `Watch`.

    Raises
    ------
    TimeoutError
        If they take longer than `max_seconds`. Like KeyboardInterrupt, it has the attribute `curve`.
    """
    watch = Watch(total, expected, max_seconds)
    try:
        with reporting_to(watch):
            yield
    except INTERRUPTIONS as stop:
        vars(stop).setdefault("curve", None)
        raise
    finally:
        watch.close()


@contextmanager
def waiting(what: str) -> Iterator[Callable[[str], None]]:
    """Show the current task on a terminal, if there is one; yields a function that shows the progress."""
    terminal = sys.stderr.isatty()

    def show(words: str) -> None:
        if terminal:
            print(ERASE + words, end="", file=sys.stderr, flush=True)

    show(what)
    try:
        yield lambda far: show(f"{what}: {far}")
    finally:
        show("")
