"""Evaluate the claims of a scene, and write them into its dataset and a Markdown file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from weier.checks import unknown
from weier.data.files import write_text
from weier.pipeline.claims import verdicts
from weier.pipeline.claims.claim import Case, Claim, Judgement, cases_of, judge
from weier.pipeline.claims.paper import CLAIMS
from weier.pipeline.needed_curves import Curves
from weier.scene import Mistake, Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CLAIMS", "Claim", "Judgement", "check", "evaluate", "write"]

# Variables that no claim uses: they take much of the memory of a large study.
UNUSED = ("indentation", "residual", "work", "settings", "status", "origin", "contact_edge")


def check(scene: Scene) -> Iterator[Mistake]:
    """Yield mistakes for claims of a scene that are not in CLAIMS, or about traces: all are about the series."""
    traces = {name for name, study in scene.studies.items() for product in study.products if "trace" in product.axes}
    for name, studies in scene.claims.items():
        if name not in CLAIMS:
            yield Mistake(("claims", name), unknown("a claim", name, CLAIMS))
        for study in traces.intersection(studies):
            yield Mistake(("claims", name), f"claims are about the Weierstrass series, and {study} has a trace")


def write(curves: Curves, path: str | Path, table: str | Path) -> None:
    """Judge the claims of a scene; write its whole dataset with them, and a Markdown text of them."""
    # Checking the names of claims does not need xarray.
    from weier.pipeline import gather

    # Only the studies of claims are read into memory, each once.
    scene = curves.scene
    read = cache(lambda study: gather.read_study(curves, study, UNUSED))
    judged = {name: evaluate(name, map(read, studies)) for name, studies in scene.claims.items()}
    step = "checked against the paper" if judged else "gathered"
    gather.write(curves, path, step, verdicts.to_dataset(judged))
    write_text(table, verdicts.to_markdown(scene.title, judged))


def evaluate(name: str, studies: Iterable[xr.Dataset]) -> Judgement:
    """Judge a claim on these studies; a case of several studies counts once."""
    whole, fewer = dict[str, Case](), dict[str, Case]()
    for study in studies:
        every_second = slice((study.sizes["mean_pressure"] - 1) % 2, None, 2)  # includes the last load
        for found, own in ((whole, study), (fewer, study.isel(mean_pressure=every_second))):
            found |= {str(case["key"]): case for case in cases_of(own)}
    return judge(CLAIMS[name], list(whole.values()), list(fewer.values()))
