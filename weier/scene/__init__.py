"""Scenes: files that define what is solved and drawn, and the cases that follow from them.

`weier.load_scene` reads a file and reports its mistakes; `load` here does not check figures and claims.
Imports data, methods, theory, surface and kernels only, and solves nothing itself.
"""

from weier.scene.case import Case
from weier.scene.cases import Scene
from weier.scene.figure import BY_DEFAULT, Figure, Grouping
from weier.scene.file import load
from weier.scene.yaml import Mistake, SceneError

__all__ = [
    "BY_DEFAULT",
    "Case",
    "Figure",
    "Grouping",
    "Mistake",
    "Scene",
    "SceneError",
    "load",
]
