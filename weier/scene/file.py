"""Scene files are read, checked and expanded into scenes; an error names the file and the key."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from weier.data.variables import of_curves
from weier.data.yaml import number, parse_yaml
from weier.methods.registry import PLANNED, find_method, names, returned_by
from weier.methods.settings import checked_settings
from weier.scene.cases import Figure, Grouping, Scene, SceneError
from weier.scene.products import MAX_CASES, axes, axis, check_count
from weier.scene.study import CaseProduct, Study
from weier.theory.loads import check_range, checked_loads

NAME = r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}"
BATCH_SIZE = 25  # cases: a batch takes 0.3 s to start, and 3 s on a cluster
MAX_BATCH_BYTES = 4 * 2**30  # of one batch
RENAMED_KEYS = {"most_cases": "max_cases"}

Raw = Mapping[str, Any]  # of the file, as the schema has it


def load(path: str | Path) -> Scene:
    """Read and check a scene file.

    Raises
    ------
    SceneError
        If the file is missing, is not YAML, has an unknown key, or a value out of range.

    """
    path = Path(path)
    try:
        return _load(path.read_text(encoding="utf-8"), path)
    except (OSError, UnicodeDecodeError) as error:
        raise _unreadable(path, error) from None


@lru_cache(maxsize=1)  # for the jobs of one scene, which are forked from a process that has loaded it
def _load(text: str, path: Path) -> Scene:
    try:
        raw = parse_yaml(text)
    except ValueError as error:
        raise _unreadable(path, error) from None
    _check_schema(raw, path)
    return _scene(raw, text, path)


def _unreadable(path: Path, error: Exception) -> SceneError:
    return SceneError(f"{path} cannot be read as a scene: {_one_line(error)}")


def load_by_name(name: str, folder: str | Path = "config/scenes") -> Scene:
    """The scene of this name in a folder of scenes; a SceneError if the name could lead elsewhere."""
    if not re.fullmatch(NAME, name):
        raise SceneError(f"a scene's name must be letters, digits, _ and -, at most 64, got {name!r:.80}")
    return load(Path(folder, f"{name}.yaml"))


def schema() -> dict[str, Any]:
    """The JSON schema of scene files, with the names of all methods there are."""
    loaded = json.loads(files("weier.scene").joinpath("schema.json").read_text(encoding="utf-8"))
    loaded["$defs"]["method"]["enum"] = names()
    loaded["$defs"]["parameter"]["enum"] = ["method", *loaded["$defs"]["profile"]["properties"]]
    return loaded


def _check_schema(raw: Any, path: Path) -> None:
    import jsonschema  # takes longer than the rest of a scene, and nothing else needs it

    for old, new in RENAMED_KEYS.items():
        if isinstance(raw, dict) and old in raw:
            raise SceneError(f"{path}: {old}: this key is called {new} now: rename it")
    error = jsonschema.exceptions.best_match(jsonschema.Draft202012Validator(schema()).iter_errors(raw))
    if error is not None:
        where = ".".join(str(part) for part in error.absolute_path) or "the top level"
        why = error.validator_value["description"] if error.validator == "not" else error.message
        raise SceneError(f"{path}: {where}: {_one_line(why)}")


def _scene(raw: Raw, text: str, path: Path) -> Scene:
    with _in_file(path, "loads"):
        loads = _loads(raw)
    with _in_file(path, "studies"):
        check_count(raw["studies"], int(raw.get("max_cases", MAX_CASES)))
    with _in_file(path, "tolerance"):
        plan = _plan(raw)
    studies = {}
    for name, study in raw["studies"].items():
        with _in_file(path, f"studies.{name}"):
            studies[name] = _study(study, raw, plan)
    with _in_file(path, "figures"):
        figures = _figures(raw)
    scene = Scene(
        name=path.stem,
        title=raw["title"],
        loads=loads,
        studies=studies,
        batch_size=int(raw.get("batch", BATCH_SIZE)),
        figures=figures,
        claims={name: tuple(wanted) for name, wanted in raw.get("claims", {}).items()},
        contact_edges=raw.get("contact_edges", False),
        text=text,
    )
    _check_references(scene, path)
    with _in_file(path, "batch"):
        _check_memory(scene)
    return scene


def _loads(raw: Raw) -> NDArray[np.float64]:
    loads = checked_loads([number("a load", value) for value in axis(raw["loads"])])
    check_range(loads)
    return loads


def _plan(raw: Raw) -> dict[str, Any]:
    """Settings of the method that plans, for all studies of a scene with a tolerance; else none."""
    if "tolerance" not in raw:
        return {}
    quantity = {"quantity": raw["quantity"]} if "quantity" in raw else {}
    return quantity | {"tolerance": number("tolerance", raw["tolerance"])}


def _study(study: Raw, raw: Raw, plan: Mapping[str, Any]) -> Study:
    methods = tuple(study.get("methods", raw.get("methods", ())))
    settings = study.get("settings", raw.get("settings", {}))
    if plan:
        methods, settings = tuple(dict.fromkeys((*methods, PLANNED))), {PLANNED: plan} | settings
    checked = {method: checked_settings(find_method(method), settings.get(method, {})) for method in methods}
    own = {method: values for method, values in checked.items() if method in settings}
    products = [CaseProduct(values, methods, own) for values in axes(study)]
    for product in products:
        product.check()
    return Study(products)


def _figures(raw: Raw) -> dict[str, Figure]:
    return {
        name: Figure(
            figure["draw"], tuple(figure.get("studies", ())), figure.get("title", ""), _grouping(name, figure)
        )
        for name, figure in raw.get("figures", {}).items()
    }


def _grouping(name: str, figure: Raw) -> Grouping:
    over = figure.get("median over", [])
    grouping = Grouping(
        figure.get("colour", ""), figure.get("facet", ""), tuple(over if isinstance(over, list) else [over])
    )
    given = [each for each in (grouping.colour, grouping.facet, *grouping.median_over) if each]
    for each in given:
        if given.count(each) > 1:
            raise ValueError(f"{name}: {each} can be the colour, the facet or one to take the median over, not two")
    return grouping


def _check_references(scene: Scene, path: Path) -> None:
    """Refuse figures and claims of studies that are not there."""
    users = {f"figures.{name}": figure.studies for name, figure in scene.figures.items()}
    users |= {f"claims.{name}": wanted for name, wanted in scene.claims.items()}
    for where, wanted in users.items():
        for study in wanted:
            if study not in scene.studies:
                raise SceneError(f"{path}: {where}: there is no study {study!r}, only {', '.join(scene.studies)}")


def _check_memory(scene: Scene) -> None:
    """Refuse batches that do not fit into memory."""
    methods, _, edges = scene.layout
    cases = max(map(len, scene.batches.values()))
    variables = len(of_curves(returned_by(methods), edges=False))
    needed = 8 * cases * scene.loads.size * (len(methods) * variables + edges)
    if needed > MAX_BATCH_BYTES:
        raise ValueError(
            f"a batch must fit into {MAX_BATCH_BYTES >> 30} GB, got {needed >> 30} GB: set a smaller batch, "
            "fewer loads, or contact_edges: false"
        )


@contextmanager
def _in_file(path: Path, where: str) -> Iterator[None]:
    """Turn a ValueError into a SceneError that names the file and the key."""
    try:
        yield
    except ValueError as error:
        raise SceneError(f"{path}: {where}: {_one_line(error)}") from None


def _one_line(error: object) -> str:
    return " ".join(str(error).split())
