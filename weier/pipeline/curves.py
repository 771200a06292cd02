"""The solved curves of all scenes: batches in one folder, each of one method, looked up curve by curve.

A curve depends only on its surface, its method with all settings, the loads, and the code and packages that compute
it, so that scenes share curves. The name of a batch is a digest of these.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from weier.data.files import write_text
from weier.digests import PACKAGE, digest, digest_of_callables, versions
from weier.kernels.arrays import Array, Indices
from weier.methods.registry import find_method
from weier.methods.settings import all_settings
from weier.scene.case import Case
from weier.scene.cases import Scene
from weier.scene.identity import Keys, Lookup, as_text, from_text
from weier.surface.loads import LoadsOf
from weier.theory.conduction import full_contact_pressure

if TYPE_CHECKING:
    from weier.surface.measured.trace import Trace
    from weier.surface.waves import Waves

# The surfaces, and what a batch computes from them besides a method.
OF_SERIES = (("weier.surface.profile", "Profile"), ("weier.surface.profile", "random_phases"))
OF_TRACES = (("weier.surface.measured.trace", "Trace"),)
OF_ALL = (
    ("weier.api.task", "CurveTask"),
    ("weier.api.batch", "describe_case"),
    ("weier.api.batch", "_bounds"),
    ("weier.kernels.jit", "OPTIONS"),
)
# Other methods, and what files say of variables, change no curve.
NOT_FOLLOWED = ("weier.methods.registry", "weier.data.variables")
PART = ".part"  # The suffix of the curves of a batch that was interrupted.
CODE_DIGITS = 12  # of the digest of the code that files state


@cache
def numerics(method: str, is_trace: bool) -> dict[str, str]:
    """Return a digest of the code that computes the curves of a method, and the versions of its packages."""
    found = find_method(method)
    measured = [path for path in (PACKAGE / "surface" / "measured").glob("*.py") if path.stem != "trace"]
    code = digest_of_callables(
        (found.solve, found.applies),
        *OF_ALL,
        *(OF_TRACES if is_trace else OF_SERIES),
        # a trace is identified by its heights, not its file
        stop=[*NOT_FOLLOWED, *(f"weier.surface.measured.{path.stem}" for path in measured)],
    )
    # Curves of methods without phases are shared.
    return {"code": digest([code, found.uses_phases])[:CODE_DIGITS], "packages": versions()}


class Kind(NamedTuple):
    """The common properties of the curves of a batch.

    method, settings : the method with all its settings
    loads : in p_0*, or in Pa with `modulus`
    contact_edges : whether the edges of contact are kept
    numerics : as `numerics` returns them
    modulus : composite modulus in Pa, which gives the loads of each trace in p_0*
    """

    method: str
    settings: Mapping[str, Any]
    loads: Sequence[float]
    contact_edges: bool
    numerics: Mapping[str, str]
    modulus: float | None = None

    @property
    def loads_of(self) -> LoadsOf | None:
        """The function from a trace to its loads in p_0*, if those of the kind are in Pa."""
        if (modulus := self.modulus) is None:
            return None

        def loads_of(surface: Waves) -> Array:
            trace = cast("Trace", surface)
            return np.array(self.loads) / full_contact_pressure(modulus, trace.lambda_0, trace.g_0)

        return loads_of

    @property
    def name(self) -> str:
        """The beginning of the names of its batches."""
        return f"{self.method}-{digest(list(self))[:8]}"


def kind_of(case: Case, method: str, scene: Scene) -> Kind:
    """Return the kind of the curve of a case by one of its methods.

    A series has its loads in p_0*, so that scenes with other bodies share its curves.
    """
    settings = dict(sorted(all_settings(find_method(method), case.settings.get(method, {})).items()))
    loads, modulus, is_trace = scene.loads, None, "trace" in case.parameters
    if scene.in_si and (bodies := scene.interface):
        loads = loads if is_trace else bodies.normalised_pressure(loads)
        modulus = bodies.composite_modulus if is_trace else None
    return Kind(method, settings, loads.tolist(), scene.contact_edges, numerics(method, is_trace), modulus)


class Batch(NamedTuple):
    """A batch: cases, each with the method of its kind alone.

    surfaces : the keys of their surfaces
    studies : the studies that contain them, for messages
    seconds : expected on one core
    job : names of the batches that one job solves, in their order; the last one stands for all
    """

    kind: Kind
    cases: Sequence[Case]
    surfaces: Keys
    studies: Sequence[str]
    seconds: float
    job: Sequence[str] = ()

    @property
    def name(self) -> str:
        """A digest of all dependencies of its curves."""
        return f"{self.kind.name}-{digest([self.kind._asdict(), as_text(self.surfaces)])[:12]}"

    @property
    def title(self) -> str:
        """The number of cases, their studies and the method, in a few words."""
        first, last = self.studies[0], self.studies[-1]
        count = f"{len(self.surfaces)} case{'s' * (len(self.surfaces) > 1)}"
        return f"{count} {f'of {first}' if first == last else f'from {first} to {last}'} by {self.kind.method}"

    def describe(self) -> str:
        """Return its description as two lines of JSON: the batch, and its cases, as tables of parameters of one kind.

        Only the process that solves the batch reads the second line, which takes a hundred times as long.
        """
        tables: dict[tuple[str, ...], list[list[Any]]] = {}
        order = []
        for case in self.cases:
            names = tuple(case.parameters)
            tables.setdefault(names, []).append(list(case.parameters.values()))
            order.append(list(tables).index(names))
        own = {"surfaces": as_text(self.surfaces), "studies": self.studies, "seconds": self.seconds, "job": self.job}
        cases = {"tables": list(tables.items()), "order": order, "given": self.cases[0].settings}
        return f"{json.dumps(self.kind._asdict() | own)}\n{json.dumps(cases)}\n"


def title_of(job: Sequence[Batch]) -> str:
    """Return the title of the batches of a job."""
    if len(job) == 1:
        return job[0].title
    methods = dict.fromkeys(batch.kind.method for batch in job)
    return f"{sum(len(batch.surfaces) for batch in job)} curves by {', '.join(methods)}"


def read_batch(path: str | Path) -> Batch:
    """Read the description of a batch, and its cases on access; ValueError if the file is none."""
    try:
        with Path(path).open(encoding="utf-8") as file:
            raw = json.loads(file.readline())
        kind, surfaces = Kind(*(raw[name] for name in Kind._fields)), from_text(raw["surfaces"])
        cases = CasesOfFile(Path(path), kind.method, len(surfaces))
        return Batch(kind, cases, surfaces, raw["studies"], raw["seconds"], raw.get("job", [Path(path).stem]))
    except (OSError, TypeError, KeyError, ValueError) as error:
        raise _no_batch(path, error) from None


class CasesOfFile(Sequence[Case]):
    """The cases of a batch, which are read from its description on access."""

    def __init__(self, path: Path, method: str, count: int) -> None:
        self._path, self._method, self._count = path, method, count

    def __len__(self) -> int:
        """Return the number of cases."""
        return self._count

    def __getitem__(self, position: Any) -> Any:
        """Return the case at a position."""
        return self._cases[position]

    @cached_property
    def _cases(self) -> list[Case]:
        try:
            raw = json.loads(self._path.read_text(encoding="utf-8").splitlines()[1])
            tables = [
                iter([Case(dict(zip(names, row, strict=True)), (self._method,), raw["given"]) for row in rows])
                for names, rows in raw["tables"]
            ]
            return [next(tables[number]) for number in raw["order"]]
        except (OSError, TypeError, KeyError, ValueError, IndexError, StopIteration) as error:
            raise _no_batch(self._path, error) from None


def _no_batch(path: str | Path, error: Exception) -> Exception:
    if isinstance(error, TimeoutError):  # of a program with a time limit, which says nothing about the file
        return error
    return ValueError(f"{path} does not describe a batch: delete it and run snakemake again ({error})")


class Store:
    """The batches of a folder: the solved ones, and those that this process has described.

    Each has a description, NAME.json, and its curves if it is solved, NAME.nc.

    Attributes
    ----------
    batches : list of path
        Descriptions of the batches that are known; places refer to them by number.
    described : dict of Batch
        Those that this process has described, by their names.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.batches: list[Path] = []
        self.described: dict[str, Batch] = {}
        self._last: dict[str, str] = {}
        self._written = set[str]()
        self._known: dict[str, list[tuple[int, Keys]]] = {}
        self._lookups: dict[str, tuple[Lookup, Indices, Indices]] = {}

    def find(self, kind: Kind, surfaces: Keys) -> tuple[Indices, Indices]:
        """Return the number of the batch, and the row in it, of the curve of each surface; -1 where there is none."""
        lookup, batch, row = self._lookup(kind.name)
        place = lookup.find(surfaces)  # -1 is the last entry, for no batch
        return np.append(batch, -1)[place], np.append(row, -1)[place]

    def add(self, job: Sequence[Batch]) -> None:
        """Add batches that one job is to solve, of which the last one stands for all; `write` describes them."""
        names = [batch.name for batch in job]
        for name, batch in zip(names, job, strict=True):
            self.described[name] = batch._replace(job=names)
            self._batches_of(batch.kind.name)  # those that are solved
            self._number(batch.kind.name, name, self.described[name])
            self._lookups.pop(batch.kind.name, None)

    def target(self, name: str) -> Path:
        """Return the file by which Snakemake knows a batch: that of the last batch of its job, unless it was lost."""
        last = self._last[name]
        return self.folder / f"{last if last in self.described or last in self.solved else name}.nc"

    def write(self) -> None:
        """Write the descriptions of this process, each once, also in place of one that an older version has left."""
        for name in self.described.keys() - self._written:
            write_text(self.folder / f"{name}.json", self.described[name].describe())
            self._written.add(name)

    def batch(self, name: str) -> Batch:
        """Return the batch of this name."""
        return self.described[name] if name in self.described else read_batch(self.folder / f"{name}.json")

    def job(self, name: str) -> list[Batch]:
        """Return the batches that are solved with this one if it is the last of its job, or this one."""
        batch = self.batch(name)
        others = batch.job[:-1] if batch.job[-1] == name else ()
        left = [each for each in others if each in self.described or (self.folder / f"{each}.json").exists()]
        return [*map(self.batch, left), batch]

    @cached_property
    def solved(self) -> dict[str, int]:
        """The names of all solved batches, with their sizes in bytes."""
        sizes = {entry.name: entry.stat().st_size for entry in self._entries() if entry.is_file()}
        named = {name[:-3]: size for name, size in sizes.items() if name.endswith(".nc")}
        return {name: size for name, size in sorted(named.items()) if f"{name}.json" in sizes}

    def _entries(self) -> Iterable[os.DirEntry[str]]:
        return os.scandir(self.folder) if self.folder.is_dir() else ()

    def _batches_of(self, kind: str) -> list[tuple[int, Keys]]:
        """Return the numbers of the batches of a kind, with the keys of their surfaces."""
        if kind not in self._known:
            self._known[kind] = []
            for name in self.solved:
                if name.startswith(f"{kind}-"):
                    self._number(kind, name, read_batch(self.folder / f"{name}.json"))
        return self._known[kind]

    def _number(self, kind: str, name: str, batch: Batch) -> None:
        """Give a batch of a kind its number."""
        self._known[kind].append((len(self.batches), batch.surfaces))
        self.batches.append(self.folder / f"{name}.json")
        self._last[name] = batch.job[-1]

    def _lookup(self, kind: str) -> tuple[Lookup, Indices, Indices]:
        if kind not in self._lookups:
            known = self._batches_of(kind)
            sizes = [len(keys) for _, keys in known]
            every = np.concatenate([np.empty(0, np.uint64), *(keys for _, keys in known)])
            batch = np.repeat([number for number, _ in known], sizes).astype(int)
            row = np.concatenate([np.empty(0, int), *map(np.arange, sizes)]).astype(int)
            self._lookups[kind] = Lookup(every), batch, row
        return self._lookups[kind]


def cut(seconds: Array, most: int, cores: int) -> list[slice]:
    """Divide curves, in order, among jobs of about equal time: two per core, or one if they are short.

    No job is expected to take longer than `MAX_SECONDS`, unless a single curve does, and none has more than `most`.
    """
    if not seconds.size:
        return []
    total, middle = float(seconds.sum()), np.cumsum(seconds) - seconds / 2
    few = min(cores, math.ceil(total / START_SECONDS))
    many = cores * min(JOBS_PER_CORE, int(total / cores / MIN_SECONDS))
    number = np.floor(max(few, many, math.ceil(total / MAX_SECONDS)) * middle / total)
    ends = [*(np.flatnonzero(np.diff(number)) + 1).tolist(), seconds.size]
    parts = []
    for start, end in zip([0, *ends], ends, strict=False):
        size = math.ceil((end - start) / math.ceil((end - start) / most))
        parts += [slice(first, min(first + size, end)) for first in range(start, end, size)]
    return parts


# Seconds to start a process, the least time of a job with less than one per core, and those for the closed forms of a
# case and for writing its values: `python -m weier.accuracy expected_seconds` measures both.
START_SECONDS, CASE_SECONDS = 1.0, 1e-3
# arbitrary within a factor of two, since curves do not depend on the jobs that solve them: least time of a job with
# several per core, which starting it hardly prolongs; its longest time, of which a batch is lost if it is killed
MIN_SECONDS, MAX_SECONDS = 30 * START_SECONDS, 120.0
JOBS_PER_CORE = 2  # Two jobs for each core leave no core idle for long at the end.
