"""Scenes of a text, and scenes that are solved as the pipeline does it, without Snakemake."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

from weier import scene
from weier.api.batch import solve_batch
from weier.data import dataset
from weier.pipeline.batches import Solutions
from weier.scene import Scene


def scene_in(folder: Path, content: str | Mapping[str, Any], load: Callable[[Path], Scene] = scene.load) -> Scene:
    """A scene of this text, or of these values, which it writes into the folder."""
    path = folder / "scene.yaml"
    path.write_text(content if isinstance(content, str) else yaml.safe_dump(content), encoding="utf-8")
    return load(path)


def solve_scene(scene: Scene, folder: Path, cores: int = 1) -> Solutions:
    """Solve what is missing of a scene in a folder of batches, cut for so many cores."""
    solutions = Solutions(scene, folder)
    for path in solutions.files(cores=cores):
        for batch in [] if path.exists() else solutions.store.job(path.stem):
            curves = solve_batch(
                batch.cases, batch.kind.loads, batch.kind.contact_edges, loads_of=batch.kind.loads_of
            )
            dataset.write(curves, path.with_name(f"{batch.name}.nc"), batch.title, "solved", name=batch.name)
    solutions.store.write()
    return Solutions(scene, folder)
