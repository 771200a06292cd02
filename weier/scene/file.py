"""Scene files are read, checked and expanded into scenes; one error lists all mistakes with their lines."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from weier.checks import checked_file, shown, suggestion
from weier.data.variables import of_curves
from weier.data.yaml import number, read_yaml
from weier.kernels.arrays import Array
from weier.methods.method import Method
from weier.methods.registry import METHODS, PLANNED, find_method
from weier.methods.settings import checked_settings
from weier.scene.case import trace_parameters
from weier.scene.cases import MAX_BATCH_CASES, Scene
from weier.scene.figure import FREE, Axis, Figure, Grouping
from weier.scene.mistakes import Keys, Mistake, Mistakes, SceneError, one_line
from weier.scene.schema import mistakes_of_form
from weier.scene.study import (
    MAX_CASES,
    CaseProduct,
    Study,
    axis,
    check_count,
    check_number,
    check_value,
    distinct_values,
    products,
)
from weier.surface.loads import check_range, listed_loads
from weier.surface.profile import PARAMETERS, Profile
from weier.theory.conduction import Interface

# The names of scenes are names of files and parts of paths of Snakemake.
NAME = r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}"
MAX_BATCH_BYTES = 4 * 2**30  # A batch must fit into the memory of one core of a usual machine.
# Settings that are words are checked on this profile, since they are valid for all profiles or for none.
ONE_WAVE = Profile(1.5, 2, 1)

Raw = Mapping[str, Any]  # The plain values of a file or a part of it.
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
    except (OSError, ValueError) as error:
        raise SceneError(f"{path} cannot be read as a scene: {one_line(error)}") from None
    mistakes = Mistakes()
    mistakes.add(mistakes_of_form(document.values))
    if not isinstance(document.values, dict):
        raise mistakes.error(path, document)
    scene = _scene(document.values, text, path, mistakes)
    for check in checks:
        mistakes.add(check(scene))
    if mistakes:
        raise mistakes.error(path, document)
    return scene


def load_by_name(name: str, folder: str | Path = "config/scenes", checks: Sequence[Check] = ()) -> Scene:
    """The scene of this name in a folder of scenes; a SceneError if there is none."""
    if not re.fullmatch(NAME, name):
        raise SceneError(f"a scene's name must be letters, digits, _ and -, at most 64, got {name!r:.80}")
    known = sorted(path.stem for path in Path(folder).glob("*.yaml"))
    if known and name not in known:
        raise SceneError(
            f"there is no scene {name!r} in {folder}, only {', '.join(known)}{suggestion(name, known)}; "
            f"a scene of your own is a file {Path(folder, name)}.yaml"
        )
    return load(Path(folder, f"{name}.yaml"), checks)


def _scene(raw: Raw, text: str, path: Path, mistakes: Mistakes) -> Scene:
    """The scene without the parts that have mistakes."""

    def sound(key: str, instead: Any) -> Any:
        return mistakes.attempt((key,), lambda: raw.get(key, instead), instead)

    _check_settings(("settings",), raw.get("settings"), mistakes)
    plan: dict[str, Any] = mistakes.attempt(("tolerance",), partial(_plan, raw), {})
    known = _mapping(raw, "studies")
    most = sound("max_cases", MAX_CASES)
    if not mistakes.within("studies"):
        mistakes.attempt(("max_cases",), partial(check_count, known, int(most)), None)
    wanted = {} if mistakes.within("max_cases") else known
    read = {study: _study(study, raw, plan, path.parent, mistakes) for study in wanted}
    lines = sum(map(len, filter(None, read.values())))  # of maps, too, whose lines are counted when they are read
    mistakes.attempt(("max_cases",), partial(check_number, lines, int(most)), None)
    interface = mistakes.attempt(("interface",), partial(_interface, raw), None)
    scene = Scene(
        name=path.stem,
        title=sound("title", ""),
        loads=mistakes.attempt(("loads",), partial(_loads, raw), np.empty(0)),
        studies={study: cases for study, cases in read.items() if cases is not None},
        figures={figure: _figure(figure, raw, interface, mistakes) for figure in _mapping(raw, "figures")},
        claims={claim: tuple(of) for claim, of in _mapping(raw, "claims").items() if isinstance(of, list)},
        max_seconds=sound("max_seconds", None),
        contact_edges=sound("contact_edges", False),
        text=text,
    )
    _check_references(scene, known, mistakes)
    most_cases = sound("batch", None)
    if mistakes:
        return scene
    return replace(scene, batch_size=mistakes.attempt(("batch",), partial(_batch_size, scene, most_cases), 1))


def _mapping(raw: Raw, key: str) -> Raw:
    """The value of a key if it is a mapping, else an empty one."""
    value = raw.get(key)
    return value if isinstance(value, dict) else {}


def _loads(raw: Raw) -> Array:
    if "loads" not in raw:  # the form reports it
        return np.empty(0)
    loads, _ = listed_loads([number("a load", value) for value in axis(raw["loads"])])
    check_range(loads)
    return loads


def _plan(raw: Raw) -> dict[str, Any]:
    """Settings of the planning method, for all studies of a scene with a tolerance; empty without one."""
    if "tolerance" not in raw:
        return {}
    quantity = {"quantity": raw["quantity"]} if "quantity" in raw else {}
    return checked_settings(find_method(PLANNED), quantity | {"tolerance": number("tolerance", raw["tolerance"])})


def _check_settings(keys: Keys, settings: Any, mistakes: Mistakes) -> None:
    """Check each setting of each method separately."""
    if not isinstance(settings, dict) or mistakes.within(*keys):
        return
    for method, values in settings.items():
        for name, value in values.items():
            mistakes.attempt((*keys, method, name), partial(_check_setting, find_method(method), name, value), None)


def _check_setting(method: Method, name: str, value: Any) -> None:
    """Refuse a setting that is invalid for every profile and all other settings."""
    checked_settings(method, {name: value})
    if isinstance(value, str):
        method.check(ONE_WAVE, **{name: value})


def _study(name: str, raw: Raw, plan: Raw, folder: Path, mistakes: Mistakes) -> Study | None:
    """The cases of a study; None if it has mistakes, or if its methods do."""
    keys: Keys = ("studies", name)
    study = _mapping(raw["studies"], name)
    _check_settings((*keys, "settings"), study.get("settings"), mistakes)
    axes = [_axes((*keys, *place), product, folder, mistakes) for place, product in products(study)]
    methods = study.get("methods", raw.get("methods", ()))
    if "trace" in study and not mistakes.within("methods"):
        mistakes.attempt((*keys, "methods"), partial(_check_methods_of_trace, methods), None)
    if any(mistakes.within(*part) for part in (keys, ("settings",), ("methods",), ("tolerance",))):
        return None
    settings = study.get("settings", raw.get("settings", {}))
    if plan and "trace" not in study:  # there are no plans for traces
        methods, settings = dict.fromkeys((*methods, PLANNED)), {PLANNED: plan} | settings
    if not methods:  # the form reports it of profiles
        return None
    checked = {method: checked_settings(find_method(method), settings.get(method, {})) for method in methods}
    own = {method: values for method, values in checked.items() if method in settings}
    made = [CaseProduct(values, tuple(methods), own) for values in axes]
    for (place, _), product in zip(products(study), made, strict=True):
        mistakes.attempt((*keys, *place), product.check, None)
    mistakes.attempt(keys, partial(_check_methods, made), None)
    return None if mistakes.within(*keys) else Study(made)


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


def _axes(keys: Keys, product: Raw, folder: Path, mistakes: Mistakes) -> dict[str, list[Any]]:
    """The values of each parameter, each checked separately."""
    if trace := product.get("trace"):  # The file must exist in any case. It is read if the study has no mistake.
        mistakes.attempt(keys, lambda: checked_file(folder / trace["file"]), None)
        wrong = mistakes.within(*keys[:2])  # in its study
        return {"trace": [] if wrong else mistakes.attempt(keys, partial(trace_parameters, trace, folder), [])}
    axes: dict[str, list[Any]] = {
        name: mistakes.attempt((*keys, name), partial(distinct_values, name, values), [])
        for name, values in product.items()
    }
    for name, values in axes.items():
        for value in values:
            mistakes.attempt((*keys, name), partial(check_value, name, value), None)
    return axes


def _interface(raw: Raw) -> Interface | None:
    """The two bodies of a scene, if it has them, with the scale of its series; traces have their own scale."""
    if "interface" not in raw:
        return None
    values = {name: number(name, value) for name, value in raw["interface"].items()}
    missing = {"lambda_0", "g_0"} - values.keys()
    if missing and not all("trace" in _mapping(raw["studies"], study) for study in _mapping(raw, "studies")):
        raise ValueError(f"{' and '.join(sorted(missing))} must be given, the scale of the series in m")
    return Interface(**values)


def _figure(name: str, raw: Raw, interface: Interface | None, mistakes: Mistakes) -> Figure:
    """A figure without the parts that have mistakes."""
    keys: Keys = ("figures", name)
    figure = _mapping(raw["figures"], name)

    def sound(key: str, instead: Any, read: Callable[[Any], Any]) -> Any:
        return mistakes.attempt((*keys, key), lambda: read(figure[key]) if key in figure else instead, instead)

    return Figure(
        draw=sound("draw", "", str),
        studies=sound("studies", (), tuple),
        title=sound("title", "", str),
        grouping=mistakes.attempt(keys, partial(_grouping, figure), Grouping()),
        x=sound("x", FREE, _axis),
        y=sound("y", FREE, _axis),
        size=sound("size", None, tuple),
        interface=mistakes.attempt((*keys, "units"), partial(_bodies, figure, raw, interface), None),
    )


def _bodies(figure: Raw, raw: Raw, interface: Interface | None) -> Interface | None:
    """The bodies that convert a figure into SI units; None if it is normalised."""
    if "units" not in figure:
        return None
    if "interface" not in raw:
        raise ValueError("SI units need the key interface of the scene, with the two bodies and their roughness")
    return interface


def _grouping(figure: Raw) -> Grouping:
    facet, over = (
        tuple(given if isinstance(given := figure.get(key, []), list) else [given])
        for key in ("facet", "median over")
    )
    grouping = Grouping(figure.get("colour", ""), facet, over)
    given = [parameter for parameter in (grouping.colour, *facet, *over) if parameter]
    for parameter in given:
        if given.count(parameter) > 1:
            raise ValueError(f"{parameter} can be the colour, the facet or one to take the median over, not two")
    return grouping


def _axis(given: str | Raw) -> Axis:
    axis = Axis(given) if isinstance(given, str) else Axis(given.get("scale", ""), given.get("from"), given.get("to"))
    ends = [end for end in axis[1:] if end is not None]
    if not np.isfinite(ends).all():
        raise ValueError("the ends of an axis must be finite")
    if axis.scale == "log" and min(ends, default=1.0) <= 0:
        raise ValueError(f"a logarithmic axis must lie above 0, got {min(ends):g}")
    if len(ends) == 2 and ends[0] >= ends[1]:
        raise ValueError(f"an axis must begin below its end, got {ends[0]:g} to {ends[1]:g}")
    return axis


def _check_references(scene: Scene, studies: Raw, mistakes: Mistakes) -> None:
    """Refuse figures and claims of unknown studies."""
    lists: dict[Keys, Sequence[str]] = {("claims", name): of for name, of in scene.claims.items()}
    lists |= {("figures", name, "studies"): figure.studies for name, figure in scene.figures.items()}
    for keys, listed in lists.items():
        for position, study in enumerate(() if mistakes.within(*keys) else listed):
            if study not in studies:
                what = f"there is no study {shown(study)}, only {', '.join(studies) or 'none':.300}"
                mistakes.add([Mistake((*keys, position), f"{what}{suggestion(study, studies)}")])


def _batch_size(scene: Scene, wanted: int | None) -> int:
    """The most cases in a batch, which must fit into memory."""
    methods, _, edges, optional = scene.layout
    variables = len(of_curves(optional, edges=False))
    case = 8 * scene.loads.size * (len(methods) * variables + edges)
    needed = case * int(wanted or 1)
    if needed > MAX_BATCH_BYTES:
        raise ValueError(
            f"a batch must fit into {MAX_BATCH_BYTES >> 30} GB, got {needed >> 30} GB: set a smaller batch, "
            "fewer loads, or contact_edges: false"
        )
    return int(wanted) if wanted else min(MAX_BATCH_CASES, MAX_BATCH_BYTES // case)
