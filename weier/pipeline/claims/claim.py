"""What a claim is: a statement of the paper, and a function that measures what it says on the cases of a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

Cases = Sequence[xr.Dataset]


class Measured(NamedTuple):
    """What was measured for a claim, in words and as a number, and whether the statement holds; None if unknown."""

    text: str
    value: float = np.nan
    holds: bool | None = None


class Claim(NamedTuple):
    """A statement of the paper, the quantity measured for it, the paper's value of that (NaN for none), and how."""

    statement: str
    quantity: str
    paper_value: float
    measure: Callable[[Cases], Measured]


CLAIMS: dict[str, Claim] = {}  # by the names of their functions


def claim(
    statement: str, quantity: str, paper_value: float = np.nan
) -> Callable[[Callable[[Cases], Measured]], Callable[[Cases], Measured]]:
    """Enter the function below into CLAIMS, with its words: the decorator that makes a claim of a function."""

    def enter(measure: Callable[[Cases], Measured]) -> Callable[[Cases], Measured]:
        CLAIMS[measure.__name__] = Claim(statement, quantity, paper_value, measure)
        return measure

    return enter


def judge(text: str, value: float, conditions: Iterable[tuple[bool, str]]) -> Measured:
    """What was measured, and whether all conditions of the statement are met; the text names those that are not.

    Parameters
    ----------
    text : str
        What was measured, in whole sentences.
    value : float
        The quantity of the claim.
    conditions : iterable of (met, objection)
        What the statement says, and a clause that tells why it does not hold where the condition is not met.

    """
    objections = [objection for met, objection in conditions if not met]
    reason = f" The statement does not hold here: {'; '.join(objections)}." if objections else ""
    return Measured(text + reason, value, not objections)
