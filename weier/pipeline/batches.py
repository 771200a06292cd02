"""The curves of a scene: the batches that hold them, and new batches of those that are missing."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.digests import digest
from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.registry import find_method, methods_run_by
from weier.pipeline.curves import CASE_SECONDS, Batch, Kind, Store, cut, kind_of
from weier.scene.case import Case
from weier.scene.cases import Scene
from weier.scene.identity import Keys, digest_of_keys, distinct, key_of
from weier.scene.study import CaseProduct

SEEDS = ("phases", "seed")  # a curve's time hardly depends on these


class Part(NamedTuple):
    """The curves of a product of cases by one method.

    first : index of its first case in the scene; the others follow
    positions : of its cases in the product
    surfaces : their keys
    """

    kind: Kind
    first: int
    product: CaseProduct
    positions: Indices
    surfaces: Keys

    @property
    def cases(self) -> slice:
        """Indices of its cases in the scene."""
        return slice(self.first, self.first + len(self.positions))

    def batch_case(self, number: int) -> Case:
        """Return one of its cases, with the method alone."""
        found = self.product.case(int(self.positions[number]))
        own = {self.kind.method: found.settings[self.kind.method]} if self.kind.method in found.settings else {}
        return Case(found.parameters, (self.kind.method,), own)

    def seconds(self) -> Array:
        """Return the expected seconds of each curve."""
        loads, loads_of, axes = np.array(self.kind.loads), self.kind.loads_of, self.product.axes
        shape = [len(values) for values in axes.values()]
        costs = np.zeros([1 if name in SEEDS else len(values) for name, values in axes.items()])
        # those that differ in phases alone are solved once, if the method uses none
        shared = 1 if find_method(self.kind.method).uses_phases else math.prod(shape) / costs.size
        for place in np.ndindex(costs.shape):
            case = self.product.case(int(np.ravel_multi_index(place, shape)))
            own = loads if loads_of is None else loads_of(case.profile)
            costs[place] = CASE_SECONDS + case.seconds(self.kind.method, own) / shared
        return np.broadcast_to(costs, shape).ravel()[self.positions]


class Solutions:
    """The curves of a scene in a folder of batches, which other scenes may use, too.

    Parameters
    ----------
    scene : Scene
        The scene.
    curves : Store or path
        The batches, or their folder.

    Attributes
    ----------
    to_solve : list of list of Batch
        The jobs that `files` has described, each a list of batches.
    """

    def __init__(self, scene: Scene, curves: Store | str | Path) -> None:
        self.scene = scene
        self.store = curves if isinstance(curves, Store) else Store(curves)
        self.to_solve: list[list[Batch]] = []
        self._digests: dict[frozenset[str], str] = {}  # of curves, by studies

    @cached_property
    def parts(self) -> list[Part]:
        """The curves of the scene, by product and method, in their order."""
        scene, found = self.scene, []
        product_of_case = scene.product_of_cases
        starts = np.searchsorted(product_of_case, np.arange(len(scene.products) + 1))
        for product, start, end in zip(scene.products, starts, starts[1:], strict=False):
            if end > start:
                positions = scene.position_in_product[start:end]
                surfaces = product.surface_keys[positions]
                for method in product.methods:
                    kind = kind_of(product.case(0), method, scene)
                    found.append(Part(kind, int(start), product, positions, surfaces))
        return found

    def places(
        self, method: str, studies: Collection[str] | None = None
    ) -> tuple[Indices, Indices, NDArray[np.object_]]:
        """Return the batch and the row of the curve of each case by a method, and its code.

        The batch is a number in `store.batches`, and -1 for cases that the method is not to solve.

        Raises
        ------
        ValueError
            If a curve of these studies, or of any if none are named, is not solved.
        """
        wanted = self._cases_of(studies)
        batch, row = np.full((2, len(self.scene.distinct)), -1)
        code = np.full(len(batch), "", object)
        for part in self.parts:
            if part.kind.method == method:
                batch[part.cases], row[part.cases] = self.store.find(part.kind, part.surfaces)
                code[part.cases] = part.kind.numerics["code"]
                if (missing := np.flatnonzero((batch[part.cases] < 0) & wanted[part.cases])).size:
                    case = part.batch_case(int(missing[0]))
                    raise ValueError(
                        f"{case.profile.describe()} is not solved by {method} in {self.store.folder}: "
                        "run snakemake again"
                    )
        return batch, row, code

    def batches(self, studies: Collection[str] | None = None, cores: int = 1) -> list[str]:
        """Return the names of the batches of these studies, or of the whole scene: solved ones, and new ones of jobs.

        Jobs contain only curves of these studies that no earlier call has described, so that a case of two figures is
        solved once. They are sized for this number of cores, and each needs the kernels of one method, or none;
        `store.write` writes their descriptions.
        """
        wanted = self._cases_of(studies)
        missing: dict[tuple[str, ...], dict[str, list[tuple[Part, Indices]]]] = {}
        batches = [self.store.find(part.kind, part.surfaces)[0] for part in self.parts]
        for part, batch in zip(self.parts, batches, strict=True):
            lacking = np.flatnonzero((batch < 0) & wanted[part.cases])
            if lacking.size:
                compiled = tuple(method.name for method in methods_run_by(part.kind.method) if method.numerical)
                missing.setdefault(compiled, {}).setdefault(part.kind.name, []).append((part, lacking))
        for by_kind in missing.values():
            self._describe(list(itertools.chain.from_iterable(by_kind.values())), cores)
        used = dict[int, None]()
        for part, batch in zip(self.parts, batches, strict=True):
            own = batch[wanted[part.cases]]
            if (own < 0).any():
                own = self.store.find(part.kind, part.surfaces[wanted[part.cases]])[0]
            used |= dict.fromkeys(own[np.sort(np.unique(own, return_index=True)[1])].tolist())
        return [self.store.batches[number].stem for number in used]

    def files(self, studies: Collection[str] | None = None, cores: int = 1) -> list[Path]:
        """Return the files by which Snakemake knows these batches: the last one of each job."""
        return list(dict.fromkeys(map(self.store.target, self.batches(studies, cores))))

    def digest_of_curves(self, studies: Collection[str] | None = None) -> str:
        """Return a digest of all dependencies of the curves of these studies, in whatever batches they are."""
        names = frozenset(self.scene.studies if studies is None else studies)
        if names not in self._digests:
            wanted, own = self._cases_of(names), dict[str, list[Keys]]()
            for part in self.parts:
                if len(surfaces := part.surfaces[wanted[part.cases]]):
                    own.setdefault(json.dumps(part.kind._asdict(), sort_keys=True), []).append(surfaces)
            every = [[kind, digest_of_keys(np.sort(np.concatenate(own[kind])))] for kind in sorted(own)]
            self._digests[names] = digest(every)
        return self._digests[names]

    def _cases_of(self, studies: Collection[str] | None) -> Flags:
        wanted = np.full(len(self.scene.distinct), studies is None)
        for study in studies or ():
            wanted[self.scene.cases_of_study(study)] = True
        return wanted

    def _describe(self, parts: Sequence[tuple[Part, Indices]], cores: int) -> None:
        """Describe jobs of curves whose parts are in the order of their kinds; a job has a batch for each kind."""
        keys = [part.surfaces[lacking] + key_of(part.kind.name) for part, lacking in parts]
        first = distinct(np.concatenate(keys))[0]  # curves shared by cases that differ in other methods
        surfaces = np.concatenate([part.surfaces[lacking] for part, lacking in parts])[first]
        seconds = np.concatenate([part.seconds()[lacking] for part, lacking in parts])[first]
        owner = np.repeat(np.arange(len(parts)), [len(lacking) for _, lacking in parts])[first]
        number = np.concatenate([lacking for _, lacking in parts])[first]
        case = np.concatenate([part.first + lacking for part, lacking in parts])[first]
        kinds = [part.kind for part, _ in parts]
        kind = np.unique([each.name for each in kinds], return_inverse=True)[1][owner]
        names, home = self.scene.homes
        for piece in cut(seconds, self.scene.batch_size, cores):
            job = []
            for own in np.split(np.arange(piece.start, piece.stop), np.flatnonzero(np.diff(kind[piece])) + 1):
                cases = CasesOfParts([part for part, _ in parts], owner[own], number[own])
                homes = [names[each] for each in dict.fromkeys(home[case[own]].tolist())]
                studies = list(dict.fromkeys(itertools.chain.from_iterable(homes)))
                expected = float(seconds[own].sum())
                job.append(Batch(kinds[owner[own[0]]], cases, surfaces[own], studies, expected))
            self.store.add(job)
            self.to_solve.append(job)


class CasesOfParts(Sequence[Case]):
    """Cases of some parts, which are made on access."""

    def __init__(self, parts: Sequence[Part], owner: Indices, number: Indices) -> None:
        self._parts, self._owner, self._number = parts, owner, number

    def __len__(self) -> int:
        """Return the number of cases."""
        return len(self._owner)

    def __getitem__(self, position: Any) -> Any:
        """Return the case at a position."""
        return self._parts[self._owner[position]].batch_case(int(self._number[position]))


def unused(store: Store, scenes: Collection[Solutions]) -> Mapping[str, int]:
    """Return the solved batches that none of these scenes uses, with their sizes in bytes.

    The last batch of a job is the file by which Snakemake knows the others, and is kept with them.
    """
    used = {name for own in scenes for batch in own.batches() for name in (batch, own.store.batch(batch).job[-1])}
    return {name: size for name, size in store.solved.items() if name not in used}
