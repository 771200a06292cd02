"""Scenes: what the pipeline solves and draws, as a file says it."""

from weier.scene.cases import Case, Figure, Layout, Scene, SceneError
from weier.scene.file import load, load_named

__all__ = ["Case", "Figure", "Layout", "Scene", "SceneError", "load", "load_named"]
