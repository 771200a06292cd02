"""The solved curves of a scene, the files that hold them, and the division of missing ones into batches.

A batch is described by a JSON file with all dependencies of its numbers: the cases, their loads, and a digest of the
program. Its name is a digest of this description, so that a solved batch never changes under its name. Its curves are
found again one by one, also after the scene has changed.
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
from weier.digests import KERNELS, digest, digest_of_sources
from weier.kernels.arrays import Array
from weier.scene.case import Case
from weier.scene.cases import Scene

NUMBERS = (*KERNELS, "data", "scene", "pipeline/batch.py")  # The numbers of a batch depend on these parts of weier.
# The least time of a batch where there are several for each core, since the start of one takes one or two seconds.
MIN_SECONDS = 30.0
MAX_SECONDS = 120.0  # The longest time of a batch, since a killed one is lost.
# The least time of a batch where there are fewer than one for each core, since the start of a process takes as long.
START_SECONDS = 1.0
BATCHES_PER_CORE = 2  # Two batches for each core leave no core idle for long at the end.
CASE_SECONDS = 1e-3  # Time for the closed forms of a case, and for writing its values.


class Place(NamedTuple):
    """The location of a curve: the description of its batch, and the number of its case in it."""

    batch: Path
    row: int


class Missing(NamedTuple):
    """A case with its methods that have not solved it, and the expected cost.

    studies : the studies that contain it
    seconds : expected of its methods
    """

    case: Case
    studies: tuple[str, ...]
    seconds: float


class Solutions:
    """The curves of a scene in a folder of batches.

    Parameters
    ----------
    scene : Scene
        The scene.
    folder : path
        Folder with the description of each batch, NAME.json, and its curves if it is solved, NAME.nc.

    Attributes
    ----------
    to_solve : dict
        The cases of each batch that `files` has described and that is not yet solved, by its description.
    """

    def __init__(self, scene: Scene, folder: str | Path) -> None:
        self.scene, self.folder = scene, Path(folder)
        self.to_solve: dict[Path, Sequence[Missing]] = {}
        self._described: dict[str, Path] = {}  # the batch of each of their curves
        self.common = {
            "program": digest_of_sources(*NUMBERS),
            "loads": scene.loads.tolist(),
            "contact_edges": scene.contact_edges,
        }

    @cached_property
    def _solved(self) -> dict[str, Place]:
        """The locations of all curves solved by this program under the loads of the scene, by `Case.curve_keys`."""
        found: dict[str, Place] = {}
        for path in sorted(self.folder.glob("*.json")):
            if path.with_suffix(".nc").exists() and (batch := read_batch(path)).common == self.common:
                for row, case in enumerate(batch.cases):
                    for curve in case.curve_keys.values():
                        found.setdefault(curve, Place(path, row))
        return found

    def places(self, case: Case) -> dict[str, Place]:
        """The locations of the curves of a case by method; ValueError if one is not solved."""
        try:
            return {method: self._solved[curve] for method, curve in case.curve_keys.items()}
        except KeyError:
            raise ValueError(
                f"{case.profile.describe()} is not solved by all of {', '.join(case.methods)} in {self.folder}: "
                "run snakemake again"
            ) from None

    def files(self, studies: Collection[str] | None = None, cores: int = 1) -> list[Path]:
        """The batches of these studies, or of the whole scene: the solved ones, and those to be solved.

        The descriptions of the latter, for so many cores, are written here. They contain only cases of these studies
        that no earlier call has described, so that a case of two figures is solved once.
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
        """The batch that contains a curve, or will contain it; None if there is none."""
        return self._solved[curve].batch if curve in self._solved else self._described.get(curve)

    def _describe(self, members: Sequence[Missing]) -> Path:
        """The path of the description of a batch of these cases, which is written if it is missing."""
        of = list(dict.fromkeys(study for member in members for study in member.studies))
        cases = [member.case for member in members]
        content = self.common | {"cases": [[case.parameters, case.methods, case.settings] for case in cases]}
        path = self.folder / f"{of[0]}-{digest(content)[:12]}.json"
        if not path.exists():
            seconds = sum(member.seconds for member in members)
            write_text(path, json.dumps(content | {"studies": of, "seconds": seconds}))
        self.to_solve[path] = members
        self._described |= {curve: path for case in cases for curve in case.curve_keys.values()}
        return path

    def tidy(self) -> None:
        """Remove batches of other states of the program, and descriptions of batches that were never solved."""
        for path in self.folder.glob("*.json"):
            if not path.with_suffix(".nc").exists() or read_batch(path).common["program"] != self.common["program"]:
                path.unlink()
                path.with_suffix(".nc").unlink(missing_ok=True)


class Batch(NamedTuple):
    """The description of a batch.

    common : program, loads and contact_edges, which all batches of a scene have in common
    cases : with the methods that solve them
    studies : the studies that contain the cases, for messages
    seconds : expected on one core
    """

    common: Mapping[str, Any]
    cases: list[Case]
    studies: list[str]
    seconds: float

    @property
    def title(self) -> str:
        """The number of cases and their studies, in a few words."""
        first, last = self.studies[0], self.studies[-1]
        count = f"{len(self.cases)} case{'s' * (len(self.cases) > 1)}"
        return f"{count} of {first}" if first == last else f"{count} from {first} to {last}"


def read_batch(path: str | Path) -> Batch:
    """Read the description of a batch; ValueError if the file is none."""
    try:
        raw = json.loads(Path(path).read_text(encoding="utf-8"))
        cases = [Case(parameters, tuple(methods), settings) for parameters, methods, settings in raw.pop("cases")]
        return Batch(studies=raw.pop("studies"), seconds=raw.pop("seconds"), cases=cases, common=raw)
    except (OSError, TypeError, KeyError, ValueError) as error:
        raise ValueError(f"{path} does not describe a batch: delete it and run snakemake again ({error})") from None


def cut_into_batches(members: Sequence[Missing], scene: Scene, cores: int) -> list[Sequence[Missing]]:
    """Divide cases, in their order, into batches of about equal time: two for each core, or one if they are short.

    No batch is expected to take longer than `MAX_SECONDS`, unless a single case does, and none has more cases than
    the scene allows.
    """
    if not members:
        return []
    seconds = np.array([member.seconds for member in members])
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
    """A case with the expected cost of its methods."""
    return Missing(case, studies, CASE_SECONDS + sum(case.seconds(method, loads) for method in case.methods))
