"""The products of a study: the values of each parameter, and the cases that combine them.

Each case is made on access, so that a study of a million cases takes no more memory than its axes.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from weier.kernels.arrays import Array
from weier.scene.case import Case, identity
from weier.scene.figure import PHASES
from weier.scene.identity import Keys, keys_of
from weier.scene.yaml import number
from weier.surface.profile import random_phases


@dataclass(frozen=True)
class CaseProduct:
    """Every combination of the values of each parameter, under the same methods, settings and loads.

    axes : the values of each parameter, each once; those of the last one change first
    loads : mean pressures, increasing, shape (loads,), in the unit of the scene
    """

    axes: Mapping[str, Sequence[Any]]
    methods: tuple[str, ...]
    settings: Mapping[str, Mapping[str, Any]]
    loads: Array

    @cached_property
    def count(self) -> int:
        """The number of cases."""
        return math.prod(map(len, self.axes.values()))

    def case(self, position: int) -> Case:
        """Return the case at this position."""
        chosen = {}
        for name, values in reversed(list(self.axes.items())):
            position, index = divmod(position, len(values))
            chosen[name] = values[index]
        return Case(chosen, self.methods, self.settings)

    @cached_property
    def surface_keys(self) -> Keys:
        """The key of the surface of each case."""
        return self._keys()

    @cached_property
    def keys_without_phases(self) -> Keys:
        """The keys for methods that ignore phases: surfaces that differ only in phases share a key."""
        return self._keys(without=PHASES)

    def _keys(self, without: Collection[str] = ()) -> Keys:
        total = np.zeros(1, np.uint64)
        for name, values in self.axes.items():
            own = keys_of([name, identity(name, value)] for value in values)
            total = (total[:, None] + (own if name not in without else np.zeros_like(own))).ravel()
        return total

    @property
    def case_keys(self) -> Keys:
        """The key of each case, with its methods, settings and loads."""
        return self.surface_keys + keys_of([[self.methods, self.settings, self.loads.tolist()]])

    def representative_cases(self, *names: str) -> Iterator[Case]:
        """Yield a case for each combination of the named parameters; other parameters keep their first value."""
        chosen = {name: values if name in names else values[:1] for name, values in self.axes.items()}
        product = replace(self, axes=chosen)
        return map(product.case, range(product.count))

    def check(self) -> None:
        """Refuse a series beyond the limits or too fine for a method, and settings that do not apply to it.

        The limits of D and of seeds do not depend on other parameters (`check_value`), those of gamma and phases
        depend only on m, and a tolerance is hardest to reach for the largest D. So a few cases are enough.
        """
        order = {"D": sorted(self.axes["D"], key=partial(number, "D"), reverse=True)} if "D" in self.axes else {}
        hardest = replace(self, axes={**self.axes, **order})
        for names in (("D",), ("gamma", "m"), ("phases", "m")):
            for case in hardest.representative_cases(*names):
                case.check()


def check_value(name: str, value: Any) -> None:
    """Refuse a value of a parameter that is invalid for all values of the others."""
    if name == "seed":
        random_phases(value)
        return
    length = {"m": len(value)} if name == "phases" and isinstance(value, list) else {}
    _ = Case({"D": 1.5, "gamma": 2, "m": 1} | length | {name: value}, (), {}).profile


@dataclass(frozen=True)
class Study:
    """The cases of some products, one product after the other; a case of several products occurs several times."""

    products: Sequence[CaseProduct]

    def __len__(self) -> int:
        """Return the number of cases."""
        return sum(product.count for product in self.products)

    def __iter__(self) -> Iterator[Case]:
        """Yield the cases."""
        return (product.case(position) for product in self.products for position in range(product.count))
