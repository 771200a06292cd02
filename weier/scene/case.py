"""One case of a scene: a profile with the methods to run on it."""

from __future__ import annotations

import glob
import hashlib
import itertools
import json
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from weier.checks import checked_file, readable
from weier.kernels.arrays import Array
from weier.methods.registry import find_method
from weier.scene.identity import keys_of, short_keys
from weier.scene.yaml import number
from weier.surface.gaussian import gaussian
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile, checked_ratio, random_phases
from weier.surface.waves import Waves, check_resolvable
from weier.units import METRE, NONE

DIGITS = re.compile(r"(\D*)(\d*)")  # splits file names into text and digits
AGAINST = "against"  # key that names the trace of the other body
HURST = "hurst"  # only random lines have this parameter
KEPT_TRACES = 100  # traces kept in memory (at most 5 MB each), since each method reads them again


@dataclass(frozen=True)
class Case:
    """One profile with the methods to run on it and their settings, as plain values of the scene file.

    parameters : D, gamma, m, and phases or seed; or those of a trace, as `trace_parameters` gives them
    methods, settings : names of methods, and the settings of each
    surface : the profile itself, unless it is made from the parameters, since heights may not come from a file
    """

    parameters: Mapping[str, Any]
    methods: tuple[str, ...]
    settings: Mapping[str, Mapping[str, Any]]
    surface: Waves | None = None

    @cached_property
    def surface_key(self) -> np.uint64:
        """The key of the surface; it does not depend on the folder of a trace file."""
        return keys_of([name, identity(name, value)] for name, value in self.parameters.items()).sum()

    def key(self, loads: Array) -> str:
        """Return a digest of everything but the code that determines the numbers; it is the same in every file."""
        return short_keys(keys_of([[self.methods, self.settings, loads.tolist()]]) + self.surface_key)[0]

    @cached_property
    def profile(self) -> Any:
        """The profile of this case, or its trace."""
        if self.surface is not None:
            return self.surface
        p = self.parameters
        if "trace" in p:
            return _trace(p["trace"])
        phases = p.get("phases", 0.0)
        if "seed" in p:
            phases = random_phases(p["seed"])
        elif not isinstance(phases, list | tuple):
            phases = number("phases", phases)
        return Profile(number("D", p["D"]), p["gamma"], number("m", p["m"]), phases)

    def check(self) -> None:
        """Refuse a series too fine for a method, and settings that do not apply to it."""
        methods = [find_method(method) for method in self.methods]
        if any(method.numerical for method in methods) and math.isfinite(self.profile.m):
            check_resolvable(self.profile)
        for method in methods:
            if method.takes(self.profile):
                method.check(self.profile, **self.settings.get(method.name, {}))


def identity(name: str, value: Any) -> Any:
    """Return the value that identifies a parameter, however it is written: 10/2 is 5, as a gamma.

    A trace is its name and its content, not the location of its file; a random line is its parameters.
    """
    if name == "trace":
        return value if HURST in value else [value.get("name", value["file"]), value["digest"]]
    if name == "gamma":
        return str(checked_ratio(value))
    if name == "seed":
        return int(value)
    if isinstance(value, list | tuple):
        return [identity(name, one) for one in value]
    plain = number(name, value)
    return int(plain) if plain.is_integer() else plain


def trace_files(file: str, folder: Path) -> list[str]:
    """Return the files that a name in a scene refers to: one file, or the files of a pattern such as `lab/*.csv`.

    These are in natural order, 2 before 10, without hidden ones. FileNotFoundError is raised if there is none.
    """
    if glob.escape(file) == file or (folder / file).exists():
        checked_file(folder / file)
        return [file]
    found = [name for name in glob.glob(file, root_dir=folder, recursive=True) if (folder / name).is_file()]
    if not found:
        raise FileNotFoundError(f"there is no file {folder / file}")
    return sorted(found, key=lambda name: [(int(part or 0), text) for text, part in DIGITS.findall(name)])


def trace_parameters(values: Mapping[str, Any], folder: Path) -> list[dict[str, Any]]:
    """Return the parameters of a case for each trace that a key `trace` describes, with digests of the heights.

    There are several if the file is a pattern, and if several wavelengths are given for `shortest`. They are named by
    the path of the file in the scene, which distinguishes files of the same name in two folders.
    """
    traces = []
    for file, wavelength in itertools.product(trace_files(values["file"], folder), values.get("shortest", [None])):
        own = {"source": readable(file), **values, "file": str(folder / file), "shortest": wavelength}
        if AGAINST in values:
            own[AGAINST] = str(folder / values[AGAINST])
        own = {name: value for name, value in own.items() if value is not None}
        trace = read_trace(own)
        traces.append(own | {"name": trace.source, "digest": trace.digest})
    return traces


def random_parameters(values: Mapping[str, Any], seeds: Iterable[Any]) -> list[dict[str, Any]]:
    """Return the random lines of these seeds, as parameters of a case each: arguments of `weier.gaussian`.

    Numbers have 15 digits, so that 100 um is 1e-4 m to the last bit.
    """
    units = {name: NONE if name in (HURST, "rms_slope") else METRE for name in values}
    plain = {name: float(f"{number(name, value, units[name]):.15g}") for name, value in values.items()}
    plain.setdefault("rolloff", plain["length"])
    return [plain | {"seed": int(seed)} for seed in seeds]


def _trace(parameters: Mapping[str, Any]) -> Trace:
    """Return a random line, or the trace of a file; ValueError if it has changed since its digest was computed."""
    if HURST in parameters:
        return gaussian(**parameters)
    trace = read_trace(parameters)
    if parameters["digest"] != trace.digest:
        files = " or ".join(parameters[name] for name in ("file", AGAINST) if name in parameters)
        raise ValueError(f"{files} has changed since its scene was read: run snakemake again")
    return trace


def read_trace(parameters: Mapping[str, Any]) -> Trace:
    """Return the trace of a file, or the gap between it and the trace of another body.

    The parameters are keywords of `Trace.read`, with `file` in place of `path`, and `against`.
    """
    trace = _file_trace(parameters)
    if AGAINST not in parameters:
        return trace
    file = parameters[AGAINST]
    return Trace.between(trace, _file_trace({**parameters, "file": file, "source": readable(Path(file).name)}))


def _file_trace(parameters: Mapping[str, Any]) -> Trace:
    """Return the trace of a file, cached by the digest of its content."""
    with checked_file(parameters["file"]).open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    others = ("file", AGAINST, "name", "digest")
    options = {name: value for name, value in parameters.items() if name not in others}
    try:
        return _read_once(json.dumps({"path": parameters["file"], **options}), digest)
    except ValueError as error:
        name = readable(parameters["file"])
        raise ValueError(str(error) if name in str(error) else f"{name}: {error}") from None


@lru_cache(maxsize=KEPT_TRACES)
def _read_once(arguments: str, digest: str) -> Trace:
    return Trace.read(**json.loads(arguments))
