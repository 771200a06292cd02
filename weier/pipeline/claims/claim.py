"""What a claim is: a statement of the paper, and a function that judges it on the cases of a scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from weier.data.check import Check

if TYPE_CHECKING:
    import xarray as xr

Cases: TypeAlias = "Sequence[xr.Dataset]"


class Measured(NamedTuple):
    """What was measured for a claim.

    text : the numbers, in words, a line a condition
    reason : why the statement does not hold or is not decided, a sentence a line; empty where it holds
    value, spread : the quantity of the claim, as the mean over an ensemble, and its standard deviation
    members : how many profiles of different phases these are of
    outcome : whether the statement holds
    """

    text: str
    reason: str = ""
    value: float = np.nan
    spread: float = np.nan
    members: int = 0
    outcome: Check = Check.not_measured


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
