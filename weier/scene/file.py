"""Scene files are read, checked and expanded into scenes; an error lists the mistakes with their lines."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from weier.checks import checked_file, checked_word, unknown
from weier.methods.registry import default_method, find_method
from weier.methods.settings import TOLERANCE, checked_settings, with_tolerance
from weier.scene.case import trace_parameters
from weier.scene.cases import NAME, Scene
from weier.scene.mistakes import Keys, Mistake, Mistakes, SceneError, one_line
from weier.scene.study import CaseProduct, Study, check_number
from weier.scene.yaml import number, read_yaml
from weier.surface.profile import PARAMETERS
from weier.units import PASCAL

if TYPE_CHECKING:
    from weier.scene.models import SceneKeys, StudyKeys

Check = Callable[[Scene], Iterable[Mistake]]
Settings = Mapping[str, Mapping[str, Any]]


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
        If the file is missing, is not YAML, has unknown keys, or values out of range. The error lists all of these
        mistakes; without any, those of files, settings, figures and claims.

    """
    try:
        path = checked_file(path)
    except FileNotFoundError as error:
        raise SceneError(one_line(error)) from None
    try:
        text = path.read_text(encoding="utf-8")
        document = read_yaml(text)
    except TimeoutError:  # the caller's time limit
        raise
    except (OSError, ValueError) as error:
        raise SceneError(f"{path} cannot be read as a scene: {one_line(error)}") from None
    mistakes = Mistakes()
    if keys := _keys(document.values, mistakes):
        scene = _scene(keys, text, path, mistakes)
        for check in checks:
            mistakes.add(check(scene))
    if mistakes:
        raise mistakes.error(path, document)
    return scene


def load_by_name(name: str, folder: str | Path = "config/scenes", checks: Sequence[Check] = ()) -> Scene:
    """Return the scene of this name in a folder of scenes; a ValueError if there is none."""
    known = sorted(path.stem for path in Path(folder).glob("*.yaml") if re.fullmatch(NAME, path.stem))
    return load(Path(folder, f"{checked_word(f'a scene of {folder}', name, known)}.yaml"), checks)


def _keys(raw: Any, mistakes: Mistakes) -> SceneKeys | None:
    """Return the keys of a file; None if some are mistaken."""
    # Pydantic and the models take longer to import than the rest of a scene, and a job that solves needs neither.
    from pydantic import ValidationError

    from weier.scene.models import SceneKeys
    from weier.scene.sections import mistakes_of

    try:
        return SceneKeys.model_validate(raw)
    except ValidationError as error:
        mistakes.add(mistakes_of(error, raw))
        return None


def _scene(keys: SceneKeys, text: str, path: Path, mistakes: Mistakes) -> Scene:
    """Return the scene of these keys, without the studies that have mistakes."""
    settings = _settings(("settings",), keys.settings, mistakes)
    read = {name: _study(name, study, keys, settings, path.parent, mistakes) for name, study in keys.studies.items()}
    count = sum(map(len, filter(None, read.values())))
    mistakes.attempt(("max_cases",), partial(check_number, count, keys.max_cases), None)
    mistakes.add(_mistakes_of_scene(keys))
    bodies = keys.interface if keys.loads.in_si else None
    scene = Scene(
        name=path.stem,
        title=keys.title,
        load_unit=keys.loads.unit,
        studies={name: study for name, study in read.items() if study is not None},
        figures={name: figure.figure(bodies) for name, figure in keys.figures.items()},
        interface=keys.interface,
        claims={claim: tuple(studies) for claim, studies in keys.claims.items()},
        max_seconds=keys.max_seconds,
        contact_edges=keys.contact_edges,
        text=text,
    )
    if not mistakes:
        mistakes.attempt(("loads",), scene.check_loads, None)
    return scene


def _mistakes_of_scene(keys: SceneKeys) -> Iterator[Mistake]:
    """Yield mistakes in combinations of keys, and unknown names of studies."""
    if keys.loads.in_si and not keys.interface:
        yield Mistake(("loads",), f"loads in {PASCAL} need the key interface of the scene, with the two bodies")
    if keys.loads.in_si and keys.claims:
        yield Mistake(("claims",), "claims are about loads in p_0*: leave them out, or the unit of the loads")
    series = any(study.product or study.cases for study in keys.studies.values())
    if keys.interface and keys.interface.lambda_0 is None and series:
        yield Mistake(("interface",), "g_0 and lambda_0 must be given, the scale of the series in m")
    lists: dict[Keys, list[str]] = {("claims", name): studies for name, studies in keys.claims.items()}
    for name, figure in keys.figures.items():
        lists |= {("figures", name, "studies"): figure.studies, ("figures", name, "behind"): figure.behind}
    for place, listed in lists.items():
        for position, study in enumerate(listed):
            if study not in keys.studies:
                yield Mistake((*place, position), unknown("a study", study, keys.studies))


def _settings(place: Keys, settings: Settings, mistakes: Mistakes) -> dict[str, dict[str, Any]]:
    """Return the settings of methods, each checked for its range."""

    def checked(method: str, name: str, value: Any) -> dict[str, Any]:
        check = partial(checked_settings, find_method(method), {name: value})
        return mistakes.attempt((*place, method, name), check, {})

    return {
        method: {key: found for name, value in own.items() for key, found in checked(method, name, value).items()}
        for method, own in settings.items()
    }


def _study(
    name: str, study: StudyKeys, scene: SceneKeys, settings: Settings, folder: Path, mistakes: Mistakes
) -> Study | None:
    """Return the cases of a study; None if it has mistakes, or if its methods do."""
    keys: Keys = ("studies", name)
    methods = scene.methods if study.methods is None else study.methods
    if not methods and scene.tolerance is not None:
        methods = [default_method(within_tolerance=True)]
    if not methods:
        mistakes.add([Mistake(("methods",), "Field required, or tolerance, or methods of each study")])
    made = [(place, _axes((*keys, *place), product, folder, mistakes)) for place, product in study.products]
    if study.settings is not None:
        settings = _settings((*keys, "settings"), study.settings, mistakes)
    settings = mistakes.attempt((TOLERANCE,), partial(_with_tolerance, methods, settings, scene.tolerance), settings)
    loads = study.loads or scene.loads
    if loads.in_si != scene.loads.in_si:
        what = f"loads of a study must be in the unit of the scene's loads, got {loads.unit}"
        mistakes.add([Mistake((*keys, "loads"), what)])
    if any(mistakes.within(*part) for part in (keys, ("settings",), ("methods",), (TOLERANCE,))):
        return None
    own = {method: values for method, values in settings.items() if method in methods}
    pressures = np.array(loads.values, np.float64)
    products = [CaseProduct(axes, tuple(methods), own, pressures) for _, axes in made]
    for (place, _), product in zip(made, products, strict=True):
        mistakes.attempt((*keys, *place), product.check, None)
    mistakes.attempt(keys, partial(_check_methods, products), None)
    return None if mistakes.within(*keys) else Study(products)


def _with_tolerance(methods: Sequence[str], settings: Settings, tolerance: Any) -> Settings:
    """Return settings with a tolerance for all methods that take one, which is checked."""
    given = with_tolerance(methods, settings, None if tolerance is None else number(TOLERANCE, tolerance))
    return {name: checked_settings(find_method(name), own) for name, own in given.items()}


def _check_methods(products: Sequence[CaseProduct]) -> None:
    """Refuse a study in which no method applies to any profile, and give the reason for the first method."""
    cases = [case for product in products for case in product.representative_cases(*PARAMETERS)]
    if not any(find_method(method).takes(case.profile) for case in cases for method in case.methods):
        find_method(cases[0].methods[0]).check_applies(cases[0].profile)


def _axes(keys: Keys, product: Mapping[str, Any], folder: Path, mistakes: Mistakes) -> Mapping[str, list[Any]]:
    """Return the values of each parameter; the file of a trace is read."""
    if not isinstance(product.get("trace"), dict):
        return product
    return {"trace": mistakes.attempt(keys, partial(trace_parameters, product["trace"], folder), [])}
