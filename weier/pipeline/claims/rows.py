"""Cases as rows of the arrays of their study: a Dataset of each would take most of the time of a large study."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from weier.data import curves

if TYPE_CHECKING:
    import xarray as xr

THIN = 2  # Every second load is omitted to test the dependence on the choice of loads.
Arrays = Mapping[str, NDArray[Any]]


class StudyArrays:
    """The arrays of a study.

    own : arrays whose first dimension is the case, and whose last one is the load, if they depend on it
    common : values that all cases share
    over_loads : names of the arrays over the loads
    """

    def __init__(self, own: Arrays, common: Arrays, over_loads: frozenset[str]) -> None:
        self.own, self.common, self.over_loads = own, common, over_loads

    @classmethod
    def from_dataset(cls, data: xr.Dataset) -> StudyArrays:
        """Return the arrays of a dataset over cases."""
        variables = data.transpose("case", ..., "mean_pressure").variables
        ordered = {str(name): values for name, values in variables.items()}
        return cls(
            {name: values.values for name, values in ordered.items() if "case" in values.dims},
            {name: values.values for name, values in ordered.items() if "case" not in values.dims},
            frozenset(name for name, values in ordered.items() if "mean_pressure" in values.dims),
        )

    @property
    def cases(self) -> list[CaseRow]:
        """All cases."""
        return [CaseRow(self, row) for row in range(len(self.own["key"]))]

    @cached_property
    def numerical_methods(self) -> NDArray[np.object_]:
        """The most accurate numerical method that solved each case, or None."""
        solved, column = curves.most_accurate({**self.common, **self.own})
        names = np.array([*self.common["solution_method"].tolist(), None], object)
        return names[np.where(solved, column, -1)]

    @cached_property
    def thinned(self) -> StudyArrays:
        """The study at every second load and the last one."""
        every = slice((len(self.common["mean_pressure"]) - 1) % THIN, None, THIN)
        own, common = (
            {name: values[..., every] if name in self.over_loads else values for name, values in arrays.items()}
            for arrays in (self.own, self.common)
        )
        return StudyArrays(own, common, self.over_loads)


class CaseRow:
    """One case of a study; its variables are views."""

    __slots__ = "_row", "_study"

    def __init__(self, study: StudyArrays, row: int) -> None:
        self._study, self._row = study, row

    def __getitem__(self, name: str) -> Any:
        """Return the values of a variable, without the dimension of cases."""
        own = self._study.own
        return own[name][self._row] if name in own else self._study.common[name]

    @property
    def numerical_method(self) -> str | None:
        """The most accurate numerical method that solved the case, or None."""
        return cast("str | None", self._study.numerical_methods[self._row])

    @property
    def thinned(self) -> CaseRow:
        """The case at every second load and the last one."""
        return CaseRow(self._study.thinned, self._row)

    def with_values(self, values: Arrays) -> CaseRow:
        """Return the case with other values of some variables."""
        own = {name: found[self._row, None] for name, found in self._study.own.items()}
        changed = {name: found[None] for name, found in values.items()}
        return CaseRow(StudyArrays(own | changed, self._study.common, self._study.over_loads), 0)
