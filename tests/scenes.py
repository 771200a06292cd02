"""Scenes of a text, and scenes that are solved as the pipeline does it, without Snakemake."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import xarray as xr
import yaml

from weier import open_dataset, scene
from weier.api.rows import BOUNDS
from weier.data import dataset
from weier.digests import numerics
from weier.methods import registry
from weier.pipeline import claims
from weier.pipeline.jobs import solve
from weier.pipeline.needed_curves import Curves, share
from weier.pipeline.store import Store
from weier.scene import Scene


def scene_in(folder: Path, content: str | Mapping[str, Any], load: Callable[[Path], Scene] = scene.load) -> Scene:
    """A scene of this text, or of these values, which it writes into the folder."""
    path = folder / "scene.yaml"
    path.write_text(content if isinstance(content, str) else yaml.safe_dump(content), encoding="utf-8")
    return load(path)


def curves_in(scene: Scene, folder: Path) -> Curves:
    """The curves of a scene in a store."""
    return Curves(scene, Store(folder, numerics()))


def solve_scene(scene: Scene, folder: Path, jobs: int = 1) -> Curves:
    """Solve what a store lacks of a scene, by this number of jobs."""
    curves = curves_in(scene, folder)
    lacking = curves.store.lacking(curves.parts_for())
    for number in range(jobs):
        solve(share(lacking, number, jobs), curves.store, "test", lambda line: None)
    return curves_in(scene, folder)


def write_data(curves: Curves, path: Path) -> None:
    """Write the dataset of a solved scene, and the table of its claims beside it."""
    claims.write(curves, path, path.with_suffix(".md"))


def read(path: Path) -> xr.Dataset:
    """A file of the pipeline, in memory."""
    with open_dataset(path) as data:
        return data.load()


def blank(*sizes: Any, **options: Any) -> xr.Dataset:
    """An empty dataset, by default with all that any method returns."""
    returned = [*registry.returned_by(registry.names()), *BOUNDS]
    return dataset.blank(*sizes, **{"returned": returned} | options)
