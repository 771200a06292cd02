"""Which curves of a scene are solved, in which files, and how those that are missing are cut into batches.

A batch is described by a file of JSON, which holds all that its numbers depend on: the cases, their loads, and a
digest of the program. A digest of this is its name. So what is solved never changes under its name, and is found
again curve by curve, whatever a scene has asked for since.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from weier.data.files import write_text
from weier.digests import KERNELS, digest, digest_of_program
from weier.kernels.arrays import Array
from weier.methods.errors import OutOfReachError
from weier.methods.planned.plan import Plan
from weier.methods.registry import PLANNED, find_method
from weier.pipeline.plan import plan_case
from weier.scene.case import Case
from weier.scene.cases import Scene

NUMBERS = (*KERNELS, "data", "scene", "pipeline/batch.py")  # what they depend on, of the package
MIN_SECONDS = 30.0  # of a batch, as methods expect at most: a third of it is usual, and to start one takes one or two
MAX_SECONDS = 120.0  # of a batch, which is lost when it is killed
START_SECONDS = 1.0  # what a batch must be worth where there are fewer than one for each core
BATCHES_PER_CORE = 2  # so that the last ones to end leave no core idle for long
CASE_SECONDS = 1e-3  # of the closed forms of a case, and of what is written for it


class Place(NamedTuple):
    """Where a curve is kept: the description of its batch, and the number of its case there."""

    batch: Path
    row: int


class Missing(NamedTuple):
    """A case with those of its methods that have not solved it, and what that will take.

    studies : that it stands in
    seconds : of its methods at their default settings, at most, and of its plan
    refusal : why there is no plan for it
    """

    case: Case
    studies: tuple[str, ...]
    seconds: float
    refusal: str = ""


class Solutions:
    """The curves of a scene in a folder of batches.

    Parameters
    ----------
    scene : Scene
        Whose curves these are.
    folder : path
        For each batch its description, NAME.json, and its curves once it is solved, NAME.nc.

    Attributes
    ----------
    to_solve : dict
        The cases of each batch that `files` has asked for and that is not there yet, by its description.
    """

    def __init__(self, scene: Scene, folder: str | Path) -> None:
        self.scene, self.folder = scene, Path(folder)
        self.to_solve: dict[Path, Sequence[Missing]] = {}
        self._asked: dict[str, Path] = {}  # the batch that each of their curves is to be solved in
        self.common = {
            "program": digest_of_program(*NUMBERS),
            "loads": scene.loads.tolist(),
            "contact_edges": scene.contact_edges,
        }

    @cached_property
    def _solved(self) -> dict[str, Place]:
        """Where each curve is that this program has solved under the loads of the scene, by `Case.curve_keys`."""
        found: dict[str, Place] = {}
        for path in sorted(self.folder.glob("*.json")):
            if path.with_suffix(".nc").exists() and (batch := read_batch(path)).common == self.common:
                for row, case in enumerate(batch.cases):
                    for curve in case.curve_keys.values():
                        found.setdefault(curve, Place(path, row))
        return found

    def places(self, case: Case) -> dict[str, Place]:
        """Where the curve of each method of a case is; a ValueError if one is not solved."""
        try:
            return {method: self._solved[curve] for method, curve in case.curve_keys.items()}
        except KeyError:
            raise ValueError(
                f"{case.profile.describe()} is not solved by all of {', '.join(case.methods)} in {self.folder}: "
                "run snakemake again"
            ) from None

    def files(self, studies: Collection[str] | None = None, cores: int = 1) -> list[Path]:
        """The batches that hold these studies, or else all of the scene: those that are there, and those to be made.

        What is to be made for so many cores is described here. It holds nothing but cases of these studies, and none
        that was asked for before, so that a case that two figures show is solved once.
        """
        here, missing = set[Path](), list[Missing]()
        for position, home in enumerate(self.scene.studies_of_cases):
            if studies is not None and set(home).isdisjoint(studies):
                continue
            case = self.scene.distinct[position]
            batches = {method: self._batch_of(curve) for method, curve in case.curve_keys.items()}
            here |= set(filter(None, batches.values()))
            lacking = tuple(method for method, batch in batches.items() if batch is None)
            if lacking:
                missing.append(missing_case(case.with_methods(lacking), home, self.scene.loads))
        described = map(self._describe, cut_into_batches(missing, self.scene, cores))
        return [path.with_suffix(".nc") for path in (*sorted(here), *described)]

    def _batch_of(self, curve: str) -> Path | None:
        """The batch that holds a curve, or will hold it; None if it has not been asked for."""
        return self._solved[curve].batch if curve in self._solved else self._asked.get(curve)

    def _describe(self, members: Sequence[Missing]) -> Path:
        """The description of a batch of these cases, which is written unless it is there."""
        of = list(dict.fromkeys(study for each in members for study in each.studies))
        cases = [each.case for each in members]
        content = self.common | {"cases": [[case.parameters, case.methods, case.settings] for case in cases]}
        path = self.folder / f"{of[0]}-{digest(content)[:12]}.json"
        if not path.exists():
            seconds = sum(each.seconds for each in members)
            write_text(path, json.dumps(content | {"studies": of, "seconds": seconds}))
        self.to_solve[path] = members
        self._asked |= {curve: path for case in cases for curve in case.curve_keys.values()}
        return path

    def tidy(self) -> None:
        """Remove batches of another state of the program, and descriptions of what was never solved."""
        for path in self.folder.glob("*.json"):
            if not path.with_suffix(".nc").exists() or read_batch(path).common["program"] != self.common["program"]:
                path.unlink()
                path.with_suffix(".nc").unlink(missing_ok=True)


class Batch(NamedTuple):
    """What the description of a batch says.

    common : what it shares with all batches of its scene: program, loads and contact_edges
    cases : with the methods to solve them by
    studies : which the cases stand in, for people
    seconds : that it takes on one core, as far as the methods know
    """

    common: Mapping[str, Any]
    cases: list[Case]
    studies: list[str]
    seconds: float

    @property
    def title(self) -> str:
        """What it holds, in a few words."""
        first, last = self.studies[0], self.studies[-1]
        count = f"{len(self.cases)} case{'s' * (len(self.cases) > 1)}"
        return f"{count} of {first}" if first == last else f"{count} from {first} to {last}"


def read_batch(path: str | Path) -> Batch:
    """The description of a batch; a ValueError if it is none."""
    try:
        raw = json.loads(Path(path).read_text(encoding="utf-8"))
        cases = [Case(parameters, tuple(methods), settings) for parameters, methods, settings in raw.pop("cases")]
        return Batch(studies=raw.pop("studies"), seconds=raw.pop("seconds"), cases=cases, common=raw)
    except (OSError, TypeError, KeyError, ValueError) as error:
        raise ValueError(f"{path} does not describe a batch: delete it and run snakemake again ({error})") from None


def cut_into_batches(members: Sequence[Missing], scene: Scene, cores: int) -> list[Sequence[Missing]]:
    """Neighbours together, in batches of about the same seconds: two for each core, or one if these are too short.

    No batch takes longer than `MAX_SECONDS`, as far as that is known, unless a case alone does, and none has more
    cases than the scene allows.
    """
    if not members:
        return []
    seconds = np.array([each.seconds for each in members])
    total, middle = float(seconds.sum()), np.cumsum(seconds) - seconds / 2
    few = min(cores, math.ceil(total / START_SECONDS))
    many = cores * min(BATCHES_PER_CORE, int(total / cores / MIN_SECONDS))
    number = np.floor(max(few, many, math.ceil(total / MAX_SECONDS)) * middle / total)
    ends = [*(np.flatnonzero(np.diff(number)) + 1).tolist(), len(members)]
    parts = []
    for start, end in zip([0, *ends], ends, strict=False):
        size = math.ceil((end - start) / math.ceil((end - start) / scene.batch_size))
        parts += [members[first : min(first + size, end)] for first in range(start, end, size)]
    return parts


def missing_case(case: Case, studies: tuple[str, ...], loads: Array) -> Missing:
    """A case with what its methods and its plan expect."""
    methods = [find_method(name) for name in case.methods]
    seconds = [CASE_SECONDS, *(each.seconds(case.profile, loads) for each in methods if each.takes(case.profile))]
    found = plan_case(case, loads) if PLANNED in case.methods else None
    if isinstance(found, Plan):
        seconds.append(found.seconds)
    return Missing(case, studies, sum(seconds), str(found) if isinstance(found, OutOfReachError) else "")
