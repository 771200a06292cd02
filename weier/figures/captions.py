"""The caption of a figure of a scene: its title, and the words of its kind."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import NamedTuple

from weier import figures
from weier.methods.registry import find_method, numerical_names
from weier.scene import Grouping, Scene

NOUNS = {"D": "D", "gamma": "gamma", "m": "m", "seed": "seed of the phases"}
NOUNS |= {name: name for name in ("method", "phase", "phases")}


class Caption(NamedTuple):
    """The name of a figure for people, the text below it, and one line for readers who cannot see it."""

    name: str
    text: str
    alternative: str


def caption(scene: Scene, name: str) -> Caption:
    """The caption of a figure of a scene, as plain text with the paper's symbols."""
    figure = scene.figure(name)
    methods = [case.methods for study in figure.studies for case in scene.study(study)]
    described = _describe_grouping(figure.grouping) or _describe_methods(methods)
    text = figures.kinds()[figure.draw].caption.format(methods=described)
    title = name.replace("_", " ").capitalize()
    subject, *_ = re.split(r"[:.;] ?", text)
    return Caption(title, " ".join(filter(None, [figure.title and f"{figure.title}.", text])), f"{title}: {subject}")


def _describe_grouping(grouping: Grouping) -> str:
    """Sentences that say what panels, colours, lines and bands show; none where the scene does not choose."""
    sentences = []
    if grouping.facet:
        sentences.append(f"Each panel has one {NOUNS[grouping.facet]}.")
    if grouping.colour:
        sentences.append(f"Colours show the {NOUNS[grouping.colour]}.")
    if grouping.median_over:
        over = " and ".join(NOUNS[name] for name in grouping.median_over)
        sentences.append(f"Lines are medians over the {over}, and bands hold all curves.")
    return " ".join(sentences)


def _describe_methods(cases: Sequence[Collection[str]]) -> str:
    """A sentence that tells the curves of methods apart, for cases given by their methods."""
    if len(cases) > figures.MAX_PANELS:
        return "Thin lines are single profiles; thick lines and markers are medians over their phases."
    methods = {method for case in cases for method in case}
    parts = ["colours show the estimates"] if methods.difference(numerical_names()) else []
    numerical = [find_method(method).label for method in numerical_names() if method in methods]
    for number, label in enumerate(numerical):
        parts.append(f"{'markers show' if number else 'a solid line shows'} {label}")
    if any("compliance_error" in find_method(method).returns for method in methods):
        parts.append("bars show the errors that they state")
    *former, last = parts or [""]
    sentence = f"{', '.join(former)}{',' * (len(former) > 1)} and {last}" if former else last
    return f"{sentence[:1].upper()}{sentence[1:]}."
