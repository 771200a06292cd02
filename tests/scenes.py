"""Scenes that are solved as the pipeline does it, without Snakemake."""

from pathlib import Path

from weier.data import dataset
from weier.pipeline.batch import solve_batch
from weier.pipeline.batches import Solutions, read_batch
from weier.scene import Scene


def solve_scene(scene: Scene, folder: Path, cores: int = 1) -> Solutions:
    """Solve what is missing of a scene in a folder of batches, cut for so many cores."""
    for path in Solutions(scene, folder).files(cores=cores):
        if not path.exists():
            batch = read_batch(path.with_suffix(".json"))
            dataset.write(solve_batch(batch.scene, batch.cases), path, batch.title, "solved")
    return Solutions(scene, folder)
