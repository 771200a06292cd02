"""Checks of the figures and claims of scenes, before anything is solved."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from weier import scene
from weier.checks import checked_word, unknown
from weier.figures import KINDS
from weier.pipeline import claims
from weier.scene import BY_DEFAULT, Figure, Mistake, Scene
from weier.scene.cases import NAME
from weier.scene.figure import PHASES
from weier.scene.study import CaseProduct
from weier.surface.profile import PARAMETERS


def load_scene(path: str | Path) -> Scene:
    """Read a scene file and check its cases, figures and claims, as `snakemake` does.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    Scene
        The scene with its cases, loads, figures and claims.

    Raises
    ------
    SceneError
        If the file is missing, is not YAML, has unknown keys or values out of range, or figures that cannot be drawn:
        its mistakes, each with its line, its key and what is allowed.

    Examples
    --------
    >>> import weier
    >>> loaded = weier.load_scene("config/scenes/minimal.yaml")
    >>> print(loaded.count, list(loaded.studies), list(loaded.figures))
    1 ['two_waves'] ['compliance']
    """
    return scene.load(path, CHECKS)


def load_by_name(name: str, folder: str | Path = "config/scenes") -> Scene:
    """Return the scene of this name in a folder of scenes, all of it checked; ValueError if there is none."""
    known = sorted(path.stem for path in Path(folder).glob("*.yaml") if re.fullmatch(NAME, path.stem))
    return load_scene(Path(folder, f"{checked_word(f'a scene of {folder}', name, known)}.yaml"))


def check_figures(loaded: Scene) -> Iterator[Mistake]:
    """Yield mistakes in the figures of a scene, including curves that could not be distinguished."""
    for name, figure in loaded.figures.items():
        for key, text in _wrong_keys(figure, loaded):
            yield Mistake(("figures", name, *([key] if key else [])), text)


# All checks of a scene beyond its cases.
CHECKS = check_figures, claims.check


def _wrong_keys(figure: Figure, loaded: Scene) -> Iterator[tuple[str, str]]:
    """Yield mistakes of a figure with their keys; the key is "" if the whole figure is wrong."""
    if figure.draw not in KINDS:
        if figure.draw:  # a missing key is reported elsewhere
            yield "draw", unknown("a figure of studies", figure.draw, KINDS)
        return
    kind = KINDS[figure.draw]
    if kind.needs_studies and not figure.studies:
        yield "studies", "Field required: the studies that the figure shows"
    if kind.needs and not getattr(loaded, kind.needs):
        yield "draw", f"{figure.draw} needs {kind.needs}: true in the scene"
    products = [
        product for name in figure.studies if name in loaded.studies for product in loaded.studies[name].products
    ]
    if kind.grouped:
        yield from (("", text) for text in _hidden(figure, products))
    if figure.draw != "profiles" and any(product.loads.size < 2 for product in products):
        yield "studies", "a figure of curves takes at least 2 loads, got 1: give the scene or the study a range"
    others = " or ".join(name for name, kind in KINDS.items() if kind.grouped)
    if not kind.grouped and any("trace" in product.axes for product in products):
        yield "studies", f"{figure.draw} is of the series alone: leave out traces, or draw {others}"
    if figure.interface and not kind.grouped:
        yield "draw", f"{figure.draw} has no SI units: give loads in p_0*, or draw {others}"
    if (bodies := figure.interface) and figure.draw == "resistance" and not sum(bodies.resistivities):
        yield "draw", "two perfect conductors have no resistance: give rho_1 or rho_2 of the interface a value"
    if not kind.grouped and (figure.grouping != BY_DEFAULT or figure.behind):
        keys = "colour, facet, median over or behind"
        yield "", f"{figure.draw} takes no {keys}: leave them out, or draw {others}"


def _hidden(figure: Figure, products: Sequence[CaseProduct]) -> Iterator[str]:
    """Yield messages on parameters that vary between the curves of a figure without being shown."""
    grouping = figure.grouping.with_defaults(sum(product.count for product in products))
    if hidden := grouping.hidden(_varying(products)):
        yield hidden
    random = [line for product in products for line in product.axes.get("trace", ())[:1] if "seed" in line]
    if "trace" in grouping.median_over and len({json.dumps(line | {"seed": 0}) for line in random}) > 1:
        yield "a median over traces would mix random lines of other parameters in these studies: draw two figures"
    for method in dict.fromkeys(method for product in products for method in product.methods):
        own = [product.settings.get(method, {}) for product in products if method in product.methods]
        if len({json.dumps(settings, sort_keys=True) for settings in own}) > 1:
            yield f"the settings of {method} differ between these studies, and no key shows them: draw two figures"


def _varying(products: Sequence[CaseProduct]) -> list[str]:
    """Return the parameters that vary among the profiles of some products; phases are compared for equal m."""
    found = {name: set[object]() for name in (*PARAMETERS, "trace")}
    phases: dict[float, set[str]] = {}
    for product in products:
        traces = product.axes.get("trace", ())
        found["trace"].update([trace.get("digest") or json.dumps(trace) for trace in traces] or [""])
        if traces:
            continue
        for name in PARAMETERS:
            found[name].update(getattr(case.profile, name) for case in product.representative_cases(name))
        for case in product.representative_cases("m"):
            given = [json.dumps([name, value]) for name in PHASES for value in product.axes.get(name, ())] or [""]
            phases.setdefault(case.profile.m, set()).update(given if case.profile.m > 1 else [])
    several = [name for name, values in found.items() if len(values) > 1]
    by_seed = any("seed" in product.axes for product in products)
    return several + [PHASES[by_seed]] * any(len(values) > 1 for values in phases.values())
