"""The caption of a figure of a scene: its title, and the caption of its kind."""

from __future__ import annotations

import re
from typing import NamedTuple

from weier.figures import KINDS
from weier.scene import Scene


class Caption(NamedTuple):
    """The name of a figure, the text below it, and one line of alternative text."""

    name: str
    text: str
    alternative: str


def caption(scene: Scene, name: str) -> Caption:
    """Return the caption of a figure of a scene, as plain text with the paper's symbols."""
    figure = scene.figure(name)
    text = KINDS[figure.draw].caption
    title = name.replace("_", " ").capitalize()
    subject, *_ = re.split(r"[:.;] ?", text)
    return Caption(title, f"{figure.title}. {text}" if figure.title else text, f"{title}: {subject}")
