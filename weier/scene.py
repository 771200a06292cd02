"""From a scene file to its cases: read, check, expand, and cut into batches."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from weier import plain_yaml
from weier.limits import check_resolvable
from weier.loads import check_range, checked_loads
from weier.methods import NUMERICAL, PLANNED
from weier.plain_yaml import number
from weier.profile import Profile, RandomPhases, random_phases
from weier.solve import check_settings
from weier.variables import of_curves

Array = NDArray[np.float64]
Item = TypeVar("Item")

NAME = r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}"
BATCH = 25  # cases a job: some seconds of work for one or two of start-up

# What a scene or a command may ask for, so that a slip of the pen ends in a sentence and not in a lost night.
MOST_CASES = 10_000  # by default
MOST_RANGE = 10**6
MOST_TERMS = 1000  # of a finite series: the closed forms add them one by one
MOST_GAMMA = 10**6
MOST_PHASE = 1e6  # radians: a float of more has lost the digits that matter
MOST_BYTES = 4 * 2**30  # of one batch


class SceneError(ValueError):
    """A scene file that cannot be run: the message names the file and the key."""


@dataclass(frozen=True)
class Case:
    """One profile with the methods to run on it and their settings, as plain values of the scene file."""

    parameters: Mapping[str, Any]
    methods: tuple[str, ...]
    settings: Mapping[str, Mapping[str, Any]]

    @property
    def definition(self) -> str:
        """All that the numbers depend on but the loads, as text."""
        return json.dumps([self.parameters, self.methods, self.settings], sort_keys=True)

    @cached_property
    def key(self) -> str:
        """A digest of the definition: the same case has the same name in every file."""
        return hashlib.sha256(self.definition.encode()).hexdigest()[:12]

    @cached_property
    def profile(self) -> Profile:
        """The profile of this case."""
        p = self.parameters
        phases = random_phases(p["seed"]) if "seed" in p else p.get("phases", number("phase", p.get("phase", 0.0)))
        return Profile(number("D", p["D"]), p["gamma"], number("m", p["m"]), phases)

    def check(self) -> None:
        """Refuse a series that no computer holds.

        Raises
        ------
        ValueError
            If it has too many terms or waves, or is no series at all.
        """
        profile = self.profile
        if profile.gamma > MOST_GAMMA:
            raise ValueError(f"gamma must be at most {MOST_GAMMA}, got {_short(profile.gamma)}")
        if math.isinf(profile.m):
            return
        if profile.m > MOST_TERMS:
            raise ValueError(f"m must be at most {MOST_TERMS}, or inf, got {profile.m:g}")
        drawn = isinstance(profile.phases, RandomPhases)  # within a turn, and slow to draw for each of 10^6 cases
        if not drawn and (largest := np.abs(profile.phase).max()) > MOST_PHASE:
            raise ValueError(f"phases must lie in [-{MOST_PHASE:g}, {MOST_PHASE:g}], got {largest:g}")
        if any(method in NUMERICAL for method in self.methods):
            check_resolvable(profile)


class Layout(NamedTuple):
    """What the arrays of some cases must hold.

    methods : of all of them, in order of appearance
    terms : of the longest finite series
    edges : of contact, at most, two for each of the finest waves in a period; 0 where they are not kept
    """

    methods: tuple[str, ...]
    terms: int
    edges: int


@dataclass(frozen=True)
class Figure:
    """What a figure draws (a module of weier.figures) and from which studies."""

    draw: str
    studies: tuple[str, ...]
    title: str


@dataclass(frozen=True)
class Scene:
    """A checked scene.

    name, title : of the file and for people
    loads : mean pressures, shape (loads,), in p_0*
    studies : cases of each study, in the order of the file
    figures, claims : what is made from the studies
    batch : most cases in one job
    contact_edges : whether to keep the edges of all contacts
    text : the file itself
    """

    name: str
    title: str
    loads: Array
    studies: Mapping[str, tuple[Case, ...]]
    figures: Mapping[str, Figure]
    claims: Mapping[str, tuple[str, ...]]
    batch: int
    contact_edges: bool
    text: str = ""

    @cached_property
    def cases(self) -> dict[str, Case]:
        """Every case by its key, each once, in order of appearance."""
        return {case.key: case for study in self.studies.values() for case in study}

    @cached_property
    def layout(self) -> Layout:
        """What the arrays of all cases must hold."""
        return self.layout_of(self.cases.values())

    def layout_of(self, cases: Collection[Case]) -> Layout:
        """What the arrays of some cases must hold, which is nothing that other cases need."""
        methods = dict.fromkeys(method for case in cases for method in case.methods)
        finite = [case.profile for case in cases if math.isfinite(case.profile.m)]
        edges = max((2 * profile.wavenumber[-1] for profile in finite), default=0) if self.contact_edges else 0
        return Layout(tuple(methods), max((profile.terms for profile in finite), default=1), edges)

    def study_named(self, name: str) -> tuple[Case, ...]:
        """The cases of a study.

        Raises
        ------
        SceneError
            If there is no such study.
        """
        return self._found("study", self.studies, name)

    def figure_named(self, name: str) -> Figure:
        """What a figure draws.

        Raises
        ------
        SceneError
            If there is no such figure.
        """
        return self._found("figure", self.figures, name)

    @cached_property
    def batches(self) -> dict[str, tuple[Case, ...]]:
        """Every case once, by batch: cases of the same studies together, so that a study is a set of batches."""
        homes: dict[str, dict[str, None]] = {key: {} for key in self.cases}  # a study once, in the order of the file
        for study, members in self.studies.items():
            for case in members:
                homes[case.key][study] = None
        groups: dict[str, list[Case]] = {}
        for key, home in homes.items():
            groups.setdefault("+".join(home), []).append(self.cases[key])
        return {
            f"{group}-{start // self.batch}": tuple(members[start : start + self.batch])
            for group, members in groups.items()
            for start in range(0, len(members), self.batch)
        }

    def batch_named(self, name: str) -> tuple[Case, ...]:
        """The cases of a batch.

        Raises
        ------
        SceneError
            If there is no such batch.
        """
        return self._found("batch", self.batches, name)

    def _found(self, kind: str, table: Mapping[str, Item], name: str) -> Item:
        if name not in table:
            raise SceneError(f"scene {self.name} has no {kind} {name!r}, only {', '.join(table) or 'none':.300}")
        return table[name]

    def batches_of(self, study: str) -> list[str]:
        """Names of the batches that hold the cases of a study."""
        keys = {case.key for case in self.studies[study]}
        return [name for name, cases in self.batches.items() if cases[0].key in keys]

    def digest(self, batch: str) -> str:
        """A digest of all that the numbers of a batch depend on: its own cases, the loads, what is kept."""
        cases = [case.definition for case in self.batch_named(batch)]
        definition = json.dumps([self.loads.tolist(), self.contact_edges, cases])
        return hashlib.sha256(definition.encode()).hexdigest()


def load(path: str | Path) -> Scene:
    """Read and check a scene file.

    Raises
    ------
    SceneError
        If the file is missing, is not YAML, has an unknown key, or a value out of range.

    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
        raw = plain_yaml.load(text)
    except (OSError, ValueError) as error:
        raise SceneError(f"{path} cannot be read as a scene: {_one_line(error)}") from None
    _check_schema(raw, path)
    return replace(_scene(raw, path), text=text)


def named(name: str) -> Scene:
    """The scene of this name in config/scenes.

    Raises
    ------
    SceneError
        If the name could lead elsewhere, or the scene is not sound.

    """
    if not re.fullmatch(NAME, name):
        raise SceneError(f"a scene's name must be letters, digits, _ and -, at most 64, got {name!r:.80}")
    return load(Path("config/scenes", f"{name}.yaml"))


def _check_schema(raw: Any, path: Path) -> None:
    import jsonschema  # takes longer than the rest of a scene, and no one needs it but a scene

    schema = json.loads(files("weier").joinpath("scene.schema.json").read_text(encoding="utf-8"))
    error = jsonschema.exceptions.best_match(jsonschema.Draft202012Validator(schema).iter_errors(raw))
    if error is not None:
        where = ".".join(str(part) for part in error.absolute_path) or "the top level"
        raise SceneError(f"{path}: {where}: {_one_line(error.message)}")


def _scene(raw: dict[str, Any], path: Path) -> Scene:
    loads = _checked("loads", path, lambda: checked_loads([number("a load", v) for v in _axis(raw["loads"])]))
    _checked("loads", path, lambda: check_range(loads))
    _checked("studies", path, lambda: _check_count(raw))
    studies = {name: tuple(_cases(study, raw, name, path)) for name, study in raw["studies"].items()}
    figures = {
        name: Figure(figure["draw"], tuple(figure.get("studies", ())), figure.get("title", ""))
        for name, figure in raw.get("figures", {}).items()
    }
    claims = {name: tuple(wanted) for name, wanted in raw.get("claims", {}).items()}
    for what, users in (("figures", {k: f.studies for k, f in figures.items()}), ("claims", claims)):
        for name, wanted in users.items():
            for study in wanted:
                if study not in studies:
                    raise SceneError(f"{path}: {what}.{name}: there is no study {study!r}, only {', '.join(studies)}")
    made = Scene(
        path.stem,
        raw["title"],
        loads,
        studies,
        figures,
        claims,
        int(raw.get("batch", BATCH)),
        raw.get("contact_edges", False),
    )
    largest = max(map(len, made.batches.values()))
    _checked("batch", path, lambda: _check_memory(largest, loads.size, made.layout))
    return made


def _cases(study: dict[str, Any], raw: dict[str, Any], name: str, path: Path) -> Iterator[Case]:
    methods = tuple(study.get("methods", raw.get("methods", ())))
    settings = study.get("settings", raw.get("settings", {}))
    if "tolerance" in raw:
        wanted = {"quantity": raw["quantity"]} if "quantity" in raw else {}
        wanted["tolerance"] = _checked("tolerance", path, lambda: number("tolerance", raw["tolerance"]))
        methods, settings = tuple(dict.fromkeys((*methods, PLANNED))), {PLANNED: wanted} | settings
    for method in methods:
        _checked(f"studies.{name}", path, lambda m=method: check_settings(m, settings.get(m, {})))
    for product in study.get("cases", [study.get("product")]):
        for parameters in _checked(f"studies.{name}", path, lambda p=product: list(_combinations(p))):
            case = Case(parameters, methods, {m: s for m, s in settings.items() if m in methods})
            _checked(f"studies.{name}", path, lambda c=case: c.check())
            yield case


def _combinations(product: dict[str, Any]) -> Iterator[dict[str, Any]]:
    axes = {name: values if name == "phases" else _axis(values) for name, values in product.items()}
    for combination in itertools.product(*axes.values()):
        yield dict(zip(axes, combination, strict=True))


def _check_count(raw: Mapping[str, Any]) -> None:
    """Count the cases before any is made."""
    most = int(raw.get("most_cases", MOST_CASES))
    products = [each for study in raw["studies"].values() for each in study.get("cases", [study.get("product")])]
    count = sum(math.prod(_length(values) for values in product.values()) for product in products)
    if count > most:
        raise ValueError(
            f"a scene must have at most {most} cases, got {count}: say most_cases: {count} if you mean it"
        )


def _check_memory(cases: int, loads: int, layout: Layout) -> None:
    """Refuse batches of so many cases that do not fit into memory."""
    needed = 8 * cases * loads * (len(layout.methods) * len(of_curves(layout.methods, edges=False)) + layout.edges)
    if needed > MOST_BYTES:
        raise ValueError(
            f"a batch must fit into {MOST_BYTES >> 30} GB, got {needed >> 30} GB: set a smaller batch, fewer loads, "
            "or contact_edges: false"
        )


def _short(ratio: Fraction) -> str:
    """A ratio in a few characters, be it too large for a float."""
    digits = math.log10(ratio.numerator) - math.log10(ratio.denominator)
    return f"{float(ratio):.15g}" if digits < 300 else f"about 1e{digits:.0f}"


def _length(values: Any) -> int:
    return int(values["count"]) if isinstance(values, dict) else len(values) if isinstance(values, list) else 1


def _axis(values: Any) -> list[Any]:
    """A number, a list or a range, as a list."""
    if isinstance(values, list):
        return values
    if not isinstance(values, dict):
        return [values]
    if values["count"] > MOST_RANGE:
        raise ValueError(f"a range must have at most {MOST_RANGE} values, got {values['count']}")
    ends = number("from", values["from"]), number("to", values["to"])
    if values.get("spacing") == "log" and not min(ends) > 0:
        raise ValueError(f"a range in equal ratios must lie above 0, got {min(ends):g}")
    if not np.isfinite(ends[1] - ends[0]):
        raise ValueError(f"a range must have finite ends, got {ends[0]:g} and {ends[1]:g}")
    space = np.geomspace if values.get("spacing") == "log" else np.linspace
    return [int(v) if v.is_integer() else v for v in space(*ends, int(values["count"])).tolist()]


def _checked(where: str, path: Path, make: Any) -> Any:
    try:
        return make()
    except ValueError as error:
        raise SceneError(f"{path}: {where}: {_one_line(error)}") from None


def _one_line(error: object) -> str:
    return " ".join(str(error).split())
