"""What weier raises where a solver stops short; who asks for what cannot be is told so by a ValueError."""

from __future__ import annotations


class ConvergenceError(RuntimeError):
    """A solver stopped before its answer met the contact conditions.

    Attributes
    ----------
    residual : float
        What was reached, in the solver's own measure (NaN where none was computed).
    """

    def __init__(self, message: str, residual: float = float("nan")) -> None:
        super().__init__(message)
        self.residual = residual
