"""The errors of weier other than ValueErrors for invalid arguments."""

from __future__ import annotations

MARGIN = 1.05  # A suggested tolerance, which has two digits, is not below the smallest attainable one.


class ConvergenceError(RuntimeError):
    """A solver stopped before its solution met the contact conditions.

    Attributes
    ----------
    residual : float
        The residual reached, in the measure of the solver (NaN if none was computed).
    """

    def __init__(self, message: str, residual: float = float("nan")) -> None:
        super().__init__(message)
        self.residual = residual


class NotApplicableError(ValueError):
    """The method does not apply to this profile, such as one for a single wave or for finite series."""


class OutOfReachError(NotApplicableError):
    """No method within reach is as accurate as required."""
