"""Scene files are read, checked and expanded into scenes; one error lists all mistakes with their lines."""

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
from weier.scene.study import MAX_CASES, CaseProduct, Study, check_number
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
        If the file is missing, is not YAML, has unknown keys, or values out of range; the error lists all mistakes.

    """
    try:
        path = checked_file(path)
    except FileNotFoundError as error:
        raise SceneError(one_line(error)) from None
    try:
        text = path.read_text(encoding="utf-8")
        document = read_yaml(text)
    except TimeoutError:  # of a program with a time limit
        raise
    except (OSError, ValueError) as error:
        raise SceneError(f"{path} cannot be read as a scene: {one_line(error)}") from None
    mistakes = Mistakes()
    scene = _scene(_valid_keys(document.values, mistakes), text, path, mistakes)
    for check in checks:
        mistakes.add(check(scene))
    if mistakes:
        raise mistakes.error(path, document)
    return scene


def load_by_name(name: str, folder: str | Path = "config/scenes", checks: Sequence[Check] = ()) -> Scene:
    """Return the scene of this name in a folder of scenes; a ValueError if there is none."""
    known = sorted(path.stem for path in Path(folder).glob("*.yaml") if re.fullmatch(NAME, path.stem))
    return load(Path(folder, f"{checked_word(f'a scene of {folder}', name, known)}.yaml"), checks)


def _valid_keys(raw: Any, mistakes: Mistakes) -> SceneKeys:
    """Return the keys of a file whose values are valid, and the others at their defaults."""
    # Pydantic and the models take longer to import than the rest of a scene, and a job that solves needs neither.
    from pydantic import ValidationError

    from weier.scene.models import Pressures, SceneKeys
    from weier.scene.sections import mistakes_of

    valid: dict[str, Any] = {"title": "", "loads": Pressures(), "studies": {}}
    most = raw.get("max_cases") if isinstance(raw, dict) else None
    most = most if isinstance(most, int | float) and most == most // 1 else MAX_CASES  # which inf is not
    try:
        SceneKeys.model_validate(raw, context={"valid": valid, "max_cases": most})
    except ValidationError as error:
        mistakes.add(mistakes_of(error, raw))
    return SceneKeys.model_construct(**valid)


def _scene(keys: SceneKeys, text: str, path: Path, mistakes: Mistakes) -> Scene:
    """Return the scene of valid keys, without the studies that have mistakes."""
    settings = _settings(("settings",), keys.settings, mistakes)
    count = sum(study.count for study in keys.studies.values())
    mistakes.attempt(("max_cases",), partial(check_number, count, keys.max_cases), None)
    wanted = {} if mistakes.within("max_cases") else keys.studies
    read = {name: _study(name, study, keys, settings, path.parent, mistakes) for name, study in wanted.items()}
    lines = sum(map(len, filter(None, read.values())))  # of maps, too, whose lines are counted when they are read
    mistakes.attempt(("max_cases",), partial(check_number, lines, keys.max_cases), None)
    mistakes.add(_mistakes_of_scene(keys, mistakes))
    bodies = keys.interface.bodies() if keys.interface else None
    scene = Scene(
        name=path.stem,
        title=keys.title,
        load_unit=keys.loads.unit,
        studies={name: study for name, study in read.items() if study is not None},
        figures={name: figure.figure(bodies if keys.loads.in_si else None) for name, figure in keys.figures.items()},
        interface=bodies,
        claims={claim: tuple(studies) for claim, studies in keys.claims.items()},
        max_seconds=keys.max_seconds,
        contact_edges=keys.contact_edges,
        text=text,
    )
    if not mistakes:
        mistakes.attempt(("loads",), scene.check_loads, None)
    return scene


def _mistakes_of_scene(keys: SceneKeys, mistakes: Mistakes) -> Iterator[Mistake]:
    """Yield mistakes in keys that go together, and names of studies that the scene does not have."""
    if keys.loads.in_si and not keys.interface and not mistakes.within("interface"):
        yield Mistake(("loads",), f"loads in {PASCAL} need the key interface of the scene, with the two bodies")
    if keys.loads.in_si and keys.claims:
        yield Mistake(("claims",), "claims are about loads in p_0*: leave them out, or the unit of the loads")
    if mistakes.within("studies"):
        return
    series = any(study.product or study.cases for study in keys.studies.values())
    if keys.interface and not keys.interface.lambda_0 and series:
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
    if not methods and not mistakes.within("methods"):
        mistakes.add([Mistake(("methods",), "Field required, or tolerance, or methods of each study")])
    made = [(place, _axes((*keys, *place), product, folder, mistakes)) for place, product in study.products]
    if study.settings is not None:
        settings = _settings((*keys, "settings"), study.settings, mistakes)
    settings = mistakes.attempt((TOLERANCE,), partial(_with_tolerance, methods, settings, scene.tolerance), settings)
    loads = study.loads or scene.loads
    if scene.loads.values and loads.in_si != scene.loads.in_si:
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
    """Refuse a study in which no method applies to any profile, with the reason of the first."""
    cases = [case for product in products for case in product.of_all_kinds(*PARAMETERS)]
    if not any(find_method(method).takes(case.profile) for case in cases for method in case.methods):
        find_method(cases[0].methods[0]).check_applies(cases[0].profile)


def _axes(keys: Keys, product: Mapping[str, Any], folder: Path, mistakes: Mistakes) -> Mapping[str, list[Any]]:
    """Return the values of each parameter; the file of a trace is read."""
    if not isinstance(product.get("trace"), dict):
        return product
    return {"trace": mistakes.attempt(keys, partial(trace_parameters, product["trace"], folder), [])}
