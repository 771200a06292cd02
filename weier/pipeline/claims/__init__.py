"""Evaluate the claims of a scene, and write them into its dataset and a Markdown file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from weier.api.rows import BOUNDS
from weier.checks import unknown
from weier.data.files import write_text
from weier.pipeline.claims import verdicts
from weier.pipeline.claims.claim import Claim, Judgement, judge
from weier.pipeline.claims.paper import CLAIMS
from weier.pipeline.claims.rows import CaseRow, StudyArrays
from weier.pipeline.needed_curves import Curves
from weier.scene import Mistake, Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CLAIMS", "Claim", "Judgement", "check_names", "evaluate", "write"]

# Variables that no claim uses, or only a few: they take most of the memory of a large study.
UNUSED = ("indentation", "residual", "work", "settings", "status", "origin", "contact_edge")
RARELY_USED = (*BOUNDS, "patch_count")


def check_names(scene: Scene) -> Iterator[Mistake]:
    """Yield mistakes for claims of a scene that are not in CLAIMS."""
    for name in scene.claims:
        if name not in CLAIMS:
            yield Mistake(("claims", name), unknown("a claim", name, CLAIMS))


def unused(names: Iterable[str]) -> tuple[str, ...]:
    """Return the variables that none of these claims uses."""
    used = {variable for name in names for variable in CLAIMS[name].uses}
    return UNUSED + tuple(variable for variable in RARELY_USED if variable not in used)


def write(curves: Curves, path: str | Path, table: str | Path) -> None:
    """Judge the claims of a scene; write its whole dataset with them, and a Markdown text of them.

    Parameters
    ----------
    curves : Curves
        The curves of the scene, which lists the claims with their studies.
    path, table : path
        The netCDF file and the Markdown file.

    """
    # Checking the names of claims does not need xarray.
    from weier.pipeline import gather

    # Only the studies of claims are read into memory, each once.
    scene = curves.scene
    without = unused(scene.claims)
    cases = cache(lambda study: StudyArrays.from_dataset(gather.read_study(curves, study, without)).cases)
    judged = {name: _judge(name, chain.from_iterable(map(cases, studies))) for name, studies in scene.claims.items()}
    step = "checked against the paper" if judged else "gathered"
    gather.write(curves, path, step, verdicts.to_dataset(judged))
    write_text(table, verdicts.to_markdown(scene.title, judged))


def evaluate(name: str, studies: Iterable[xr.Dataset]) -> Judgement:
    """Judge a claim on these studies; a case of several studies counts once."""
    return _judge(name, chain.from_iterable(StudyArrays.from_dataset(study).cases for study in studies))


def _judge(name: str, cases: Iterable[CaseRow]) -> Judgement:
    distinct = {str(case["key"]): case for case in cases}
    return judge(CLAIMS[name], list(distinct.values()))
