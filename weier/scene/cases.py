"""A scene and its cases."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np

from weier.digests import digest
from weier.kernels.arrays import Array, Indices
from weier.methods.registry import returned_by
from weier.scene.case import Case
from weier.scene.figure import Figure
from weier.scene.mistakes import SceneError
from weier.scene.study import CaseProduct, Study
from weier.surface.limits import resolvable

Item = TypeVar("Item")
# Names of scenes, studies, figures and claims are names of files and parts of paths of Snakemake.
NAME = r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}"
MAX_BATCH_CASES = 1000  # A process that solves and writes so many cases together takes 0.3 GB.


class Layout(NamedTuple):
    """The sizes and variables of the arrays for some cases.

    methods : of all cases, in order of appearance
    terms : of the longest finite series
    edges : the most edges of contact, two for each of the finest waves in a period; 0 if they are not kept
    optional : variables that not all files have: those that the methods return, and the labels of traces
    """

    methods: tuple[str, ...]
    terms: int
    edges: int
    optional: frozenset[str] = frozenset()


def layout_of(cases: Collection[Case], contact_edges: bool) -> Layout:
    """The sizes and variables of the arrays for these cases alone."""
    methods = dict.fromkeys(method for case in cases for method in case.methods)
    finite = [case.profile for case in cases if math.isfinite(case.profile.m)]
    resolved = filter(resolvable, finite) if contact_edges else ()
    edges = max((2 * profile.waves_per_period[-1] for profile in resolved), default=0)
    optional = frozenset(returned_by(tuple(methods))).union(*(profile.labels for profile in finite))
    terms = max((2 if len(finite) < len(cases) else 1, *(profile.listed_terms for profile in finite)))
    return Layout(tuple(methods), terms, edges, optional)


@dataclass(frozen=True)
class Scene:
    """A checked scene.

    name, title : of the file, and as a heading
    loads : mean pressures, shape (loads,), in p_0*
    studies : cases of each study, in the order of the file
    batch_size : most cases in one batch
    figures, claims : what is made from the studies
    max_seconds : the longest expected time of its solution; None without a limit
    contact_edges : whether to keep the edges of all contacts
    text : the file itself
    """

    name: str
    title: str
    loads: Array
    studies: Mapping[str, Study]
    batch_size: int = MAX_BATCH_CASES
    figures: Mapping[str, Figure] = field(default_factory=dict)
    claims: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    max_seconds: float | None = None
    contact_edges: bool = False
    text: str = ""

    @cached_property
    def products(self) -> tuple[CaseProduct, ...]:
        """The products of all studies, in the order of the file."""
        return tuple(product for study in self.studies.values() for product in study.products)

    @cached_property
    def _distinct(self) -> tuple[Indices, list[tuple[str, ...]]]:
        """The first position of each case among all studies, shape (cases,), and the studies that contain it."""
        seen: dict[tuple[str, ...], int] = {}
        identities = itertools.chain.from_iterable(product.identities for product in self.products)
        number = np.array([seen.setdefault(identity, len(seen)) for identity in identities], int)
        study = np.repeat(np.arange(len(self.studies)), [len(study) for study in self.studies.values()])
        member = np.zeros((len(seen), len(self.studies)), bool)
        member[number, study] = True
        homes, home = np.unique(member, axis=0, return_inverse=True)
        names = [tuple(itertools.compress(self.studies, row)) for row in homes]
        return np.unique(number, return_index=True)[1], [names[home_number] for home_number in home.ravel().tolist()]

    @cached_property
    def distinct(self) -> Study:
        """Every case once, in order of appearance."""
        return Study(self.products, self._distinct[0])

    @property
    def cases(self) -> dict[str, Case]:
        """Every case by its key, each once, in order of appearance: all of them in memory."""
        return {case.key: case for case in self.distinct}

    @property
    def product_of_cases(self) -> Indices:
        """The number of the first product that contains each case, in order of appearance, shape (cases,)."""
        counts = [product.count for product in self.products]
        return np.repeat(np.arange(len(counts)), counts)[self._distinct[0]]

    @property
    def studies_of_cases(self) -> list[tuple[str, ...]]:
        """The studies that each case belongs to, in order of appearance."""
        return self._distinct[1]

    @cached_property
    def layout(self) -> Layout:
        """The sizes and variables of the arrays for all cases."""
        cases = [case for product in self.products for case in product.of_all_kinds("gamma", "m")]
        return layout_of(cases, self.contact_edges)

    def study(self, name: str) -> Study:
        """The cases of a study; a SceneError if there is no such study."""
        return self._item("study", self.studies, name)

    def figure(self, name: str) -> Figure:
        """The description of a figure; SceneError if there is no such figure."""
        return self._item("figure", self.figures, name)

    def _item(self, kind: str, table: Mapping[str, Item], name: str) -> Item:
        if name not in table:
            raise SceneError(f"scene {self.name} has no {kind} {name!r}, only {', '.join(table) or 'none':.300}")
        return table[name]

    def digest_of_cases(self, *studies: str) -> str:
        """A digest of the cases of some studies in their order."""
        cases = [[product.definition for product in self.study(study).products] for study in studies]
        return digest(cases)
