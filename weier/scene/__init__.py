"""Scenes: the files that say what to solve and to draw, and the cases that they stand for.

To read a file, call `weier.load_scene`, which reports all of its mistakes: `load` here knows none of figures and
claims. May use methods, data, theory and kernels, and solves nothing itself.
"""

from weier.scene.case import Case
from weier.scene.cases import Layout, Scene
from weier.scene.figure import BY_DEFAULT, Axis, Figure, Grouping
from weier.scene.file import load, load_by_name
from weier.scene.mistakes import Mistake, SceneError

__all__ = [
    "BY_DEFAULT",
    "Axis",
    "Case",
    "Figure",
    "Grouping",
    "Layout",
    "Mistake",
    "Scene",
    "SceneError",
    "load",
    "load_by_name",
]
