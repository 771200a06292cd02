"""Exceptions that the handler of a signal raises, as in a program with a time limit of its own."""

import signal
from contextlib import contextmanager


class StoppedError(Exception):
    """An exception of a user's program."""


HANDLER_ERRORS = (TimeoutError, StoppedError)


@contextmanager
def interrupting(error, seconds=0.1):
    """Raise an error from the handler of an alarm, after some seconds."""

    def handler(number, frame):
        raise error

    before = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
