"""The caption of a figure of a scene: its title, and the caption of its kind."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple

from weier import figures
from weier.methods.registry import METHODS, find_method, numerical_names
from weier.scene import Grouping, Scene
from weier.surface.profile import PARAMETERS

# Names of parameters in sentences.
NOUNS = {name: name for name in PARAMETERS}
NOUNS |= {"method": "the method", "trace": "the trace", "phases": "the phases", "seed": "the seed of the phases"}
# Plurals of the parameters that have names in place of symbols.
PLURALS = {"method": "methods", "trace": "traces", "phases": "phases", "seed": "phases"}


class Caption(NamedTuple):
    """The name of a figure, the text below it, and one line of alternative text."""

    name: str
    text: str
    alternative: str


def caption(scene: Scene, name: str) -> Caption:
    """Return the caption of a figure of a scene, as plain text with the paper's symbols."""
    figure = scene.figure(name)
    products = [product for study in figure.studies for product in scene.study(study).products]
    methods = {method for product in products for method in product.methods}
    grouping = figure.grouping.of(sum(product.count for product in products))
    text = figures.KINDS[figure.draw].caption.format(methods=_describe_curves(grouping, methods))
    title = name.replace("_", " ").capitalize()
    subject, *_ = re.split(r"[:.;] ?", text)
    return Caption(title, " ".join(filter(None, [figure.title and f"{figure.title}.", text])), f"{title}: {subject}")


def _describe_curves(grouping: Grouping, methods: Collection[str]) -> str:
    """Return sentences that describe panels, colours, lines and bands, and the methods that are not the paper's."""
    facets = [NOUNS[name].removeprefix("the ") for name in grouping.facet if name in NOUNS]
    parts = ("panel",) if len(facets) == 1 else ("row of panels", "column")
    sentences = [f"Each {part} has one {name}." for part, name in zip(parts, facets, strict=False)]
    if grouping.colour in ("", "method"):
        sentences += _describe_methods(methods)
    else:
        dashes = ", dashes or markers the method" if "method" not in grouping.facet and len(methods) > 1 else ""
        sentences.append(f"Colours show {NOUNS[grouping.colour]}{dashes}.")
    if grouping.median_over:
        over = (f"the {PLURALS[name]}" if name in PLURALS else name for name in grouping.median_over)
        medians = f"medians over {' and '.join(dict.fromkeys(over))}"
        sentences.append(f"Lines are {medians}, and bands hold 10 to 90 % of the curves.")
    others = [method.label for method in METHODS if method.name in methods and not method.in_paper]
    if others:
        sentences.append(f"Not of the paper: {', '.join(others)}.")
    return " ".join(sentences)


def _describe_methods(methods: Collection[str]) -> list[str]:
    """Return sentences that distinguish the curves of methods."""
    estimates = ["Colours show the estimates."] if set(methods).difference(numerical_names()) else []
    numerical = [find_method(method).label for method in numerical_names() if method in methods]
    looks = ("A solid line shows", *["Markers show"] * len(numerical))
    return estimates + [f"{look} {label}." for look, label in zip(looks, numerical, strict=False)]
