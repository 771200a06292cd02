"""Scene files are read, checked and expanded into scenes; an error lists the mistakes with their lines."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from weier.checks import checked_file, unknown
from weier.methods.registry import default_method, find_method
from weier.methods.settings import TOLERANCE, checked_settings, with_tolerance
from weier.scene.case import trace_parameters
from weier.scene.cases import Scene
from weier.scene.study import CaseProduct, Study
from weier.scene.yaml import Keys, Mistake, SceneError, at, number, one_line, read_yaml, scene_error
from weier.surface.profile import PARAMETERS
from weier.units import PASCAL

if TYPE_CHECKING:
    from weier.scene.models import SceneKeys, StudyKeys

Check = Callable[[Scene], Iterable[Mistake]]
Settings = Mapping[str, Mapping[str, Any]]


def load(path: str | Path, checks: Sequence[Check] = ()) -> Scene:
    """Read a scene file and check its cases; `weier.load_scene` checks its figures and claims, too.

    SceneError is raised if the file is missing, is not YAML, has unknown keys, or values out of range. It lists all
    of these mistakes; without any, the first one of files, settings and cases; and without any, those of the checks.
    """
    # Pydantic and the models take longer to import than the rest of a scene, and Python calls need neither.
    from pydantic import ValidationError

    from weier.scene.models import SceneKeys, mistakes_of

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
    try:
        keys = SceneKeys.model_validate(document.values)
        scene = _scene(keys, text, path)
        mistakes = [*_wrong_names(keys), *chain.from_iterable(check(scene) for check in checks)]
    except ValidationError as error:
        mistakes = [*mistakes_of(error)]
    except Mistake as mistake:
        mistakes = [mistake]
    if mistakes:
        raise scene_error(path, document, mistakes)
    return scene


def _scene(keys: SceneKeys, text: str, path: Path) -> Scene:
    """Return the scene of these keys."""
    if keys.loads.in_si and not keys.interface:
        raise Mistake(("loads",), f"loads in {PASCAL} need the key interface of the scene, with the two bodies")
    if keys.loads.in_si and keys.claims:
        raise Mistake(("claims",), "claims are about loads in p_0*: leave them out, or the unit of the loads")
    series = any(study.product or study.cases for study in keys.studies.values())
    if keys.interface and keys.interface.lambda_0 is None and series:
        raise Mistake(("interface",), "g_0 and lambda_0 must be given, the scale of the series in m")
    settings = _settings(("settings",), keys.settings)
    studies = {name: _study(name, study, keys, settings, path.parent) for name, study in keys.studies.items()}
    if (count := sum(map(len, studies.values()))) > keys.max_cases:
        what = f"a scene must have at most {keys.max_cases} cases, got {count}: say max_cases: {count} if you mean it"
        raise Mistake(("max_cases",), what)
    bodies = keys.interface if keys.loads.in_si else None
    return Scene(
        name=path.stem,
        title=keys.title,
        load_unit=keys.loads.unit,
        studies=studies,
        figures={name: figure.figure(bodies) for name, figure in keys.figures.items()},
        interface=keys.interface,
        claims={claim: tuple(names) for claim, names in keys.claims.items()},
        contact_edges=keys.contact_edges,
        text=text,
    )


def _wrong_names(keys: SceneKeys) -> Iterator[Mistake]:
    """Yield unknown names of studies in figures and claims."""
    lists: dict[Keys, list[str]] = {("claims", name): studies for name, studies in keys.claims.items()}
    for name, figure in keys.figures.items():
        lists |= {("figures", name, "studies"): figure.studies, ("figures", name, "behind"): figure.behind}
    for place, listed in lists.items():
        for position, study in enumerate(listed):
            if study not in keys.studies:
                yield Mistake((*place, position), unknown("a study", study, keys.studies))


def _settings(place: Keys, settings: Settings) -> dict[str, dict[str, Any]]:
    """Return the settings of methods, each checked for its range."""
    found: dict[str, dict[str, Any]] = {method: {} for method in settings}
    for method, own in settings.items():
        for name, value in own.items():
            with at(*place, method, name):
                found[method] |= checked_settings(find_method(method), {name: value})
    return found


def _study(name: str, study: StudyKeys, scene: SceneKeys, settings: Settings, folder: Path) -> Study:
    """Return the cases of a study."""
    keys: Keys = ("studies", name)
    methods = study.methods or scene.methods
    if not methods and scene.tolerance is not None:
        methods = [default_method(within_tolerance=True)]
    if not methods:
        raise Mistake(("methods",), "Field required, or tolerance, or methods of each study")
    if study.settings is not None:
        settings = _settings((*keys, "settings"), study.settings)
    with at(TOLERANCE):
        tolerance = None if scene.tolerance is None else number(TOLERANCE, scene.tolerance)
        given = with_tolerance(methods, settings, tolerance)
        own = {name: checked_settings(find_method(name), given[name]) for name in given if name in methods}
    loads = study.loads or scene.loads
    if loads.in_si != scene.loads.in_si:
        what = f"loads of a study must be in the unit of the scene's loads, got {loads.unit}"
        raise Mistake((*keys, "loads"), what)
    products = []
    for place, axes in study.products:
        with at(*keys, *place):
            if isinstance(axes.get("trace"), dict):
                axes = {"trace": trace_parameters(axes["trace"], folder)}
            products.append(CaseProduct(axes, tuple(methods), own, np.array(loads.values, np.float64)))
            products[-1].check()
    with at(*keys):
        _check_methods(products)
    return Study(products)


def _check_methods(products: Sequence[CaseProduct]) -> None:
    """Refuse a study in which no method applies to any profile, and give the reason for the first method."""
    cases = [case for product in products for case in product.representative_cases(*PARAMETERS)]
    if not any(find_method(method).takes(case.profile) for case in cases for method in case.methods):
        find_method(cases[0].methods[0]).check_applies(cases[0].profile)
