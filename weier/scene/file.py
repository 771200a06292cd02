"""Scene files are read, checked and expanded into scenes; one error lists all mistakes with their lines."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from weier.checks import checked_file, suggestion
from weier.methods import auto
from weier.methods.registry import METHODS, find_method
from weier.methods.settings import checked_settings, with_tolerance
from weier.scene.case import trace_files, trace_parameters
from weier.scene.cases import NAME, NAME_IN_WORDS, Scene
from weier.scene.mistakes import Keys, Mistake, Mistakes, SceneError, one_line
from weier.scene.study import CaseProduct, Study, check_number
from weier.scene.yaml import read_yaml
from weier.surface.profile import PARAMETERS
from weier.units import NORMALISED_PRESSURE, PASCAL

if TYPE_CHECKING:
    from weier.scene.models import Loads, SceneKeys, StudyKeys

# Parts with a mistake are left out by themselves down to this depth below these keys, and others whole.
DEPTHS = {"studies": 1, "figures": 2, "claims": 1}

Check = Callable[[Scene], Iterable[Mistake]]


def load(path: str | Path, checks: Sequence[Check] = ()) -> Scene:
    """Read a scene file and check its cases; `weier.load_scene` checks its figures and claims, too.

    Parameters
    ----------
    path : path
        The file.
    checks : sequence of callable, optional
        Further checks of the valid parts of the scene.

    Raises
    ------
    SceneError
        If the file is missing, is not YAML, has unknown keys, or values out of range; the error lists all mistakes.

    """
    try:
        path = checked_file(path)
    except (OSError, ValueError) as error:
        raise SceneError(str(error)) from None
    try:
        text = path.read_text(encoding="utf-8")
        document = read_yaml(text)
    except TimeoutError:  # of a program with a time limit
        raise
    except (OSError, ValueError) as error:
        raise SceneError(f"{path} cannot be read as a scene: {one_line(error)}") from None
    mistakes = Mistakes()
    keys = _validated(document.values, mistakes)
    if not isinstance(document.values, dict):
        raise mistakes.error(path, document)
    scene = _scene(keys, text, path, mistakes)
    for check in checks:
        mistakes.add(check(scene))
    if mistakes:
        raise mistakes.error(path, document)
    return scene


def load_by_name(name: str, folder: str | Path = "config/scenes", checks: Sequence[Check] = ()) -> Scene:
    """Return the scene of this name in a folder of scenes; a SceneError if there is none."""
    if not re.fullmatch(NAME, name):
        raise SceneError(f"a scene's name must be {NAME_IN_WORDS}, got {name!r:.80}")
    known = sorted(path.stem for path in Path(folder).glob("*.yaml"))
    if known and name not in known:
        raise SceneError(
            f"there is no scene {name!r} in {folder}, only {', '.join(known)}{suggestion(name, known)}; "
            f"a scene of your own is a file {Path(folder, name)}.yaml"
        )
    return load(Path(folder, f"{name}.yaml"), checks)


def _validated(raw: Any, mistakes: Mistakes) -> SceneKeys:
    """Return the keys of a file, without those that have mistakes."""
    # Pydantic and the models take longer to import than the rest of a scene, and a job that solves needs neither.
    from pydantic import ValidationError

    from weier.scene.models import SceneKeys, SoundKeys
    from weier.scene.part import mistakes_of

    most = raw.get("max_cases") if isinstance(raw, dict) else None
    context = {"max_cases": most} if isinstance(most, int) else {}
    try:
        return SceneKeys.model_validate(raw, context=context)
    except ValidationError as error:
        mistakes.add(mistakes_of(error, raw))
    sound = _without_mistakes(raw, (), mistakes) if isinstance(raw, dict) else {}
    return SoundKeys.model_validate(sound, context=context)


def _without_mistakes(values: Mapping[str, Any], keys: Keys, mistakes: Mistakes) -> dict[str, Any]:
    """Return the parts of a file at these keys that have no mistake."""
    kept = {}
    for key, value in values.items():
        place = (*keys, key)
        if not mistakes.within(*place):
            kept[key] = value
        elif place not in mistakes and len(place) <= DEPTHS.get(str(place[0]), 0):
            kept[key] = _without_mistakes(value, place, mistakes)
    if keys == ("figures",):
        return {name: figure for name, figure in kept.items() if "draw" in figure}
    return kept


def _scene(keys: SceneKeys, text: str, path: Path, mistakes: Mistakes) -> Scene:
    """Return the scene without the parts that have mistakes."""
    count = sum(study.count for study in keys.studies.values())
    mistakes.attempt(("max_cases",), partial(check_number, count, keys.max_cases), None)
    wanted = {} if mistakes.within("max_cases") else keys.studies
    loads = cast("Loads", keys.loads)
    read = {name: _study(name, study, keys, path.parent, mistakes) for name, study in wanted.items()}
    lines = sum(map(len, filter(None, read.values())))  # of maps, too, whose lines are counted when they are read
    mistakes.attempt(("max_cases",), partial(check_number, lines, keys.max_cases), None)
    bodies = keys.interface.bodies() if keys.interface else None
    in_si = bool(loads) and loads.in_si
    if in_si and bodies is None and not mistakes.within("interface"):
        mistakes.add(
            [Mistake(("loads",), f"loads in {PASCAL} need the key interface of the scene, with the two bodies")]
        )
    if in_si and keys.claims:
        mistakes.add(
            [Mistake(("claims",), "claims are about loads in p_0*: leave them out, or the unit of the loads")]
        )
    scene = Scene(
        name=path.stem,
        title=keys.title,
        load_unit=loads.unit if loads else NORMALISED_PRESSURE,
        studies={name: study for name, study in read.items() if study is not None},
        figures={name: figure.figure(bodies if in_si else None) for name, figure in keys.figures.items()},
        interface=bodies,
        claims={claim: tuple(studies) for claim, studies in keys.claims.items()},
        max_seconds=keys.max_seconds,
        contact_edges=keys.contact_edges,
        text=text,
    )
    if mistakes:
        return scene
    mistakes.attempt(("loads",), scene.check_loads, None)
    return scene


def _study(name: str, study: StudyKeys, scene: SceneKeys, folder: Path, mistakes: Mistakes) -> Study | None:
    """Return the cases of a study; None if it has mistakes, or if its methods do."""
    keys: Keys = ("studies", name)
    methods = scene.methods if study.methods is None else study.methods
    tolerance = None if scene.tolerance is None else float(scene.tolerance)
    if not methods and tolerance is not None:
        methods = [auto.METHOD.name]
    if study.trace and not mistakes.within("methods"):
        mistakes.attempt((*keys, "methods"), partial(_check_methods_of_trace, methods), None)
    made = [(place, _axes((*keys, *place), product, folder, mistakes)) for place, product in study.products]
    if any(mistakes.within(*part) for part in (keys, ("settings",), ("methods",), ("tolerance",))):
        return None
    settings: Mapping[str, Mapping[str, Any]] = scene.settings if study.settings is None else study.settings
    if not methods:  # which is a mistake of its own
        return None
    settings = mistakes.attempt(keys, partial(with_tolerance, methods, settings, tolerance), settings)
    checked = {method: checked_settings(find_method(method), settings.get(method, {})) for method in methods}
    own = {method: values for method, values in checked.items() if method in settings}
    loads = cast("Loads", study.loads or scene.loads)
    if scene.loads and loads.in_si != cast("Loads", scene.loads).in_si:
        mistakes.add(
            [
                Mistake(
                    (*keys, "loads"), f"loads of a study must be in the unit of the scene's loads, got {loads.unit}"
                )
            ]
        )
    pressures = np.array(loads.values if loads else [], float)
    products = [CaseProduct(axes, tuple(methods), own, pressures) for _, axes in made]
    for (place, _), product in zip(made, products, strict=True):
        mistakes.attempt((*keys, *place), product.check, None)
    mistakes.attempt(keys, partial(_check_methods, products), None)
    return None if mistakes.within(*keys) else Study(products)


def _check_methods_of_trace(methods: Sequence[str]) -> None:
    """Refuse methods that apply to the Weierstrass series only."""
    others = [name for name in methods if not find_method(name).takes_traces]
    if others or not methods:
        takers = ", ".join(method.name for method in METHODS if method.takes_traces)
        raise ValueError(
            f"methods of a trace must be some of {takers}, got {', '.join(others) or 'none'}: give its study methods "
            "of its own, or solve the series that weier.fit finds for it"
        )


def _check_methods(products: Sequence[CaseProduct]) -> None:
    """Refuse a study in which no method applies to any profile."""
    reasons: dict[str, str] = {}
    for product in products:
        for case in product.of_all_kinds(*PARAMETERS):
            for method in map(find_method, product.methods):
                try:
                    return method.check_applies(case.profile)
                except ValueError as error:
                    reasons.setdefault(method.name, str(error))
    listed = "; ".join(f'"{name}": {reason}' for name, reason in reasons.items())
    raise ValueError(f"no method applies to any of these profiles: {listed}")


def _axes(keys: Keys, product: Mapping[str, Any], folder: Path, mistakes: Mistakes) -> dict[str, list[Any]]:
    """Return the values of each parameter; a trace is read if its study has no mistake, but must exist anyway."""
    if "trace" not in product:
        return dict(product)
    trace = product["trace"]
    mistakes.attempt(keys, lambda: trace_files(trace["file"], folder), None)
    wrong = mistakes.within(*keys[:2])  # in its study
    return {"trace": [] if wrong else mistakes.attempt(keys, partial(trace_parameters, trace, folder), [])}
