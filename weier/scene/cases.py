"""A scene and its cases."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from weier.checks import checked_word
from weier.data.bodies import Bodies
from weier.kernels.arrays import Array, Indices
from weier.scene.case import Case
from weier.scene.figure import Figure
from weier.scene.identity import Keys, distinct
from weier.scene.study import CaseProduct, Study
from weier.units import NORMALISED_PRESSURE

# Names of scenes, studies, figures and claims become file names and parts of Snakemake paths.
MAX_NAME = 64
NAME = rf"[A-Za-z0-9][A-Za-z0-9_-]{{0,{MAX_NAME - 1}}}"


@dataclass(frozen=True)
class Scene:
    """A checked scene.

    name, title : of the file, and as a heading
    studies : cases of each study, in the order of the file
    load_unit : unit in which the loads were given; studies have them in Pa unless it is p_0*
    figures, claims : what is made from the studies
    interface : the two bodies, in SI units; None without them
    contact_edges : whether to keep the edges of all contacts
    text : the file itself
    """

    name: str
    title: str
    studies: Mapping[str, Study]
    load_unit: str = NORMALISED_PRESSURE
    figures: Mapping[str, Figure] = field(default_factory=dict)
    claims: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    interface: Bodies | None = None
    contact_edges: bool = False
    text: str = ""

    @cached_property
    def products(self) -> tuple[CaseProduct, ...]:
        """The products of all studies, in the order of the file."""
        return tuple(product for study in self.studies.values() for product in study.products)

    @cached_property
    def loads(self) -> Array:
        """The loads of all studies, increasing, shape (loads,), in p_0*, or in Pa."""
        return np.unique(np.concatenate([np.empty(0), *(product.loads for product in self.products)]))

    @cached_property
    def _keys(self) -> Keys:
        """The keys of the cases of all studies in turn."""
        return np.concatenate([np.empty(0, np.uint64), *(product.case_keys for product in self.products)])

    @cached_property
    def _distinct(self) -> tuple[Indices, Indices]:
        """The first position of each distinct case in all studies, and the distinct case at each position."""
        return distinct(self._keys)

    @property
    def count(self) -> int:
        """The number of distinct cases."""
        return len(self._distinct[0])

    @cached_property
    def distinct(self) -> list[Case]:
        """Every case once, in order of appearance: all of them in memory."""
        cases = [*itertools.chain.from_iterable(self.studies.values())]
        return [cases[position] for position in self._distinct[0]]

    @property
    def keys_of_cases(self) -> Keys:
        """The key of each case, in order of appearance."""
        return self._keys[self._distinct[0]]

    @cached_property
    def product_of_cases(self) -> Indices:
        """The number of the first product that contains each case, in order of appearance, shape (cases,)."""
        counts = [product.count for product in self.products]
        return np.repeat(np.arange(len(counts)), counts)[self._distinct[0]]

    @cached_property
    def position_in_product(self) -> Indices:
        """The position of each case in the product of `product_of_cases`, shape (cases,)."""
        starts = np.cumsum([0, *(product.count for product in self.products)])
        return self._distinct[0] - starts[self.product_of_cases]

    def cases_of_study(self, name: str) -> Indices:
        """Return the positions of a study's cases among all distinct cases, in the order of the study."""
        ends = dict(zip(self.studies, itertools.accumulate(map(len, self.studies.values())), strict=True))
        return self._distinct[1][ends[name] - len(self.studies[name]) : ends[name]]

    @cached_property
    def studies_of_cases(self) -> list[str]:
        """The studies that each case belongs to, with commas between, in order of appearance."""
        found = np.full(self.count, "", object)
        for name in self.studies:
            own = np.unique(self.cases_of_study(name))
            found[own] = np.where(found[own] == "", name, found[own] + f", {name}")
        return found.tolist()

    def figure(self, name: str) -> Figure:
        """Return the description of a figure; ValueError if there is no such figure."""
        return self.figures[checked_word(f"a figure of {self.name}", name, self.figures)]

    @property
    def in_si(self) -> bool:
        """Whether loads are in Pa, and all data in SI units."""
        return self.load_unit != NORMALISED_PRESSURE
