"""Variants of methods compared with reference curves, load by load, and a table of the results."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from weier.accuracy.reference import Reference, contact_reference, deviation, own_reference
from weier.accuracy.runner import Problem, Run, attempt
from weier.data import markdown
from weier.kernels.arrays import Array


class Compared(NamedTuple):
    """The results of a variant on a problem, with the reference.

    error : errors of h and R, in g_0 and g_0/p_0*, shape (2, loads); NaN without a solution or a reference
    """

    problem: Problem
    name: str
    result: Run
    reference: Reference
    error: Array

    @property
    def ratio(self) -> Array:
        """Error over stated error, minus the uncertainty of the reference, shape (2, loads).

        It is NaN unless the reference is ten times as accurate as the stated or the measured error.
        """
        is_known = 10 * self.reference.uncertainty <= np.maximum(self.result.stated, self.error)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.maximum(self.error - self.reference.uncertainty, 0) / self.result.stated
        return np.where(is_known, ratio, np.nan)

    def exceeded(self) -> Iterator[str]:
        """Yield a sentence for each error larger than stated."""
        for quantity, load in np.argwhere(self.ratio > 1):
            error, stated = (f"{values[quantity, load]:.2e}" for values in (self.error, self.result.stated))
            settings = self.problem.variants[self.name].settings
            yield (
                f"{'hR'[quantity]} by {self.name} is off by {error}, stated {stated} ({self.problem.name}): "
                f"{self.problem.profile!r} at {self.problem.loads[load]}, {settings}"
            )


def compare(problems: Iterable[Problem], repeat: int = 1, own_sums: bool = False) -> Iterator[Compared]:
    """Run all variants on all problems, `repeat` times to measure the seconds.

    The reference is the exact contact, or with `own_sums`, for estimates, the sums that define them.
    """
    for problem in problems:
        profile, loads = problem.profile, problem.loads
        print(problem.name, file=sys.stderr)
        for name, variant in problem.variants.items():
            result = attempt(variant, profile, loads, repeat)
            if own_sums:
                right = own_reference(variant, profile, loads, result)
            else:
                right = contact_reference(profile, tuple(loads.tolist()))
            yield Compared(problem, name, result, right, deviation(result.values, right.values))


def by_problem(found: Sequence[Compared], head: str, cell: Callable[[Sequence[Compared]], str]) -> str:
    """Return a table of Markdown with a row for each name of problems and a column for each variant."""
    names = list(dict.fromkeys(one.name for one in found))
    groups: dict[str, dict[str, list[Compared]]] = {}
    for one in found:
        groups.setdefault(one.problem.name, {}).setdefault(one.name, []).append(one)
    rows = [
        [markdown.plain(problem), *(cell(own[name]) if name in own else "" for name in names)]
        for problem, own in groups.items()
    ]
    return markdown.table([head, *names], rows)
