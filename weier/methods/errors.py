"""What weier raises beside the ValueErrors that name a value, its limit and what to do."""

from __future__ import annotations


class ConvergenceError(RuntimeError):
    """A solver stopped before its solution met the contact conditions.

    Attributes
    ----------
    residual : float
        What was reached, in the solver's own measure (NaN where none was computed).
    """

    def __init__(self, message: str, residual: float = float("nan")) -> None:
        super().__init__(message)
        self.residual = residual


class NotApplicableError(ValueError):
    """The method does not apply to this profile: it is for one wave only, or for finite series only."""


class OutOfReachError(NotApplicableError):
    """No method within reach is as accurate as required."""
