"""A scene and its cases, and how they are cut into batches."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np

from weier.data.yaml import number
from weier.kernels.arrays import Array
from weier.methods.registry import find_method
from weier.theory.limits import check_resolvable
from weier.theory.phases import RandomPhases, random_phases
from weier.theory.profile import Profile

Item = TypeVar("Item")

# The most that a scene or a command may ask for, so that a slip of the pen is refused before it costs a night.
MAX_TERMS = 1000  # of a finite series: the closed forms add them one by one
MAX_GAMMA = 10**6
MAX_PHASE = 1e6  # radians: a float of more has lost the digits that matter


class SceneError(ValueError):
    """A scene file that cannot be run: the message names the file and the key."""


@dataclass(frozen=True)
class Case:
    """One profile with the methods to run on it and their settings, as plain values of the scene file."""

    parameters: Mapping[str, Any]
    methods: tuple[str, ...]
    settings: Mapping[str, Mapping[str, Any]]

    @classmethod
    def of(cls, profile: Profile, methods: tuple[str, ...], settings: Mapping[str, Mapping[str, Any]]) -> Case:
        """The case of a profile."""
        gamma = profile.gamma
        parameters: dict[str, Any] = {"D": profile.D, "m": profile.m, "gamma": str(gamma)}
        if isinstance(profile.phases, RandomPhases):
            parameters["seed"] = profile.phases.seed
        else:
            parameters["phases"] = profile.phases
        return cls(parameters, methods, settings)

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
        phases = p.get("phases", p.get("phase", 0.0))
        if "seed" in p:
            phases = random_phases(p["seed"])
        elif not isinstance(phases, list | tuple):
            phases = number("phases", phases)
        return Profile(number("D", p["D"]), p["gamma"], number("m", p["m"]), phases)

    def check(self) -> None:
        """Refuse a series that no computer holds or a method cannot resolve, and settings that do not fit it."""
        self.check_ranges()
        methods = [find_method(method) for method in self.methods]
        if any(method.numerical for method in methods) and math.isfinite(self.profile.m):
            check_resolvable(self.profile)
        for method in methods:
            if method.takes(self.profile):
                method.check(self.profile, **self.settings.get(method.name, {}))

    def check_ranges(self) -> None:
        """Refuse a series that no computer holds."""
        profile = self.profile
        if profile.gamma > MAX_GAMMA:
            raise ValueError(f"gamma must be at most {MAX_GAMMA}, got {float(profile.gamma):.15g}")
        if math.isinf(profile.m):
            return
        if profile.m > MAX_TERMS:
            raise ValueError(f"m must be at most {MAX_TERMS}, or inf, got {profile.m:g}")
        drawn = isinstance(profile.phases, RandomPhases)  # within a turn, and slow to draw for each of 10^6 cases
        if not drawn and (largest := np.abs(profile.phase).max()) > MAX_PHASE:
            raise ValueError(f"phases must lie in [-{MAX_PHASE:g}, {MAX_PHASE:g}], got {largest:g}")


class Layout(NamedTuple):
    """What the arrays of some cases must hold.

    methods : of all of them, in order of appearance
    terms : of the longest finite series
    edges : of contact, at most, two for each of the finest waves in a period; 0 where they are not kept
    """

    methods: tuple[str, ...]
    terms: int
    edges: int


class Grouping(NamedTuple):
    """Which parameters of a sweep a figure shows, and how; none where the figure chooses.

    colour, facet : the parameter that sets the colour, and the one that each panel has a value of
    median_over : over which a median is drawn, with a band that holds all curves
    """

    colour: str = ""
    facet: str = ""
    median_over: tuple[str, ...] = ()


BY_DEFAULT = Grouping()


@dataclass(frozen=True)
class Figure:
    """What a figure draws (a module of weier.figures), from which studies, and by which parameters."""

    draw: str
    studies: tuple[str, ...]
    title: str
    grouping: Grouping = BY_DEFAULT


@dataclass(frozen=True)
class Scene:
    """A checked scene.

    name, title : of the file and for people
    loads : mean pressures, shape (loads,), in p_0*
    studies : cases of each study, in the order of the file
    batch_size : most cases in one batch
    figures, claims : what is made from the studies
    contact_edges : whether to keep the edges of all contacts
    text : the file itself
    """

    name: str
    title: str
    loads: Array
    studies: Mapping[str, tuple[Case, ...]]
    batch_size: int
    figures: Mapping[str, Figure] = field(default_factory=dict)
    claims: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    contact_edges: bool = False
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
        edges = max((2 * profile.waves_per_period[-1] for profile in finite), default=0) if self.contact_edges else 0
        return Layout(tuple(methods), max((profile.terms for profile in finite), default=1), edges)

    def study(self, name: str) -> tuple[Case, ...]:
        """The cases of a study; a SceneError if there is no such study."""
        return self._item("study", self.studies, name)

    def figure(self, name: str) -> Figure:
        """What a figure draws; a SceneError if there is no such figure."""
        return self._item("figure", self.figures, name)

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
            f"{group}-{start // self.batch_size}": tuple(members[start : start + self.batch_size])
            for group, members in groups.items()
            for start in range(0, len(members), self.batch_size)
        }

    def batch(self, name: str) -> tuple[Case, ...]:
        """The cases of a batch; a SceneError if there is no such batch."""
        return self._item("batch", self.batches, name)

    def _item(self, kind: str, table: Mapping[str, Item], name: str) -> Item:
        if name not in table:
            raise SceneError(f"scene {self.name} has no {kind} {name!r}, only {', '.join(table) or 'none':.300}")
        return table[name]

    def batches_of(self, *studies: str) -> list[str]:
        """Names of the batches that hold the cases of some studies, each once."""
        keys = {case.key for study in studies for case in self.study(study)}
        return [name for name, cases in self.batches.items() if cases[0].key in keys]

    def methods_of(self, batch: str) -> tuple[str, ...]:
        """The methods that a batch runs."""
        return self.layout_of(self.batch(batch)).methods

    def digest(self, batch: str) -> str:
        """A digest of all that the scene says of the numbers of a batch: its own cases, the loads, what is kept."""
        cases = [case.definition for case in self.batch(batch)]
        return _digest([self.loads.tolist(), self.contact_edges, cases])

    def digest_of_cases(self, *studies: str) -> str:
        """A digest of which cases some studies have, and in which order."""
        return _digest([[case.key for case in self.study(study)] for study in studies])


def _digest(values: Any) -> str:
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()
