"""Scenes: the files that say what to solve and to draw, and the cases that they stand for.

May use methods, data, theory and kernels, and solves nothing itself.
"""

from weier.scene.case import Case
from weier.scene.cases import BY_DEFAULT, Figure, Grouping, Layout, Scene, SceneError
from weier.scene.file import load, load_by_name

__all__ = ["BY_DEFAULT", "Case", "Figure", "Grouping", "Layout", "Scene", "SceneError", "load", "load_by_name"]
