"""The claims of a scene: evaluated, and written into its dataset and into a text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from weier.checks import suggestion
from weier.data.files import write_text
from weier.data.provenance import source_date
from weier.pipeline.batches import Solutions
from weier.pipeline.claims import report
from weier.pipeline.claims.case import Case, Study
from weier.pipeline.claims.claim import Claim, Judgement, judge
from weier.pipeline.claims.paper import BOUNDS, CLAIMS
from weier.scene import Mistake, Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CLAIMS", "Claim", "Judgement", "check_names", "evaluate", "write"]

# Variables that no claim uses, and those that few do: most of the memory of a large study.
UNUSED = ("indentation", "residual", "work", "settings", "status", "numerics", "contact_edge")
RARELY_USED = (*BOUNDS, "patch_count")


def check_names(scene: Scene) -> Iterator[Mistake]:
    """Yield mistakes for claims of a scene that are not in CLAIMS."""
    for name in scene.claims:
        if name not in CLAIMS:
            what = f"there is no claim {name!r}, only {', '.join(CLAIMS)}{suggestion(name, CLAIMS)}"
            yield Mistake(("claims", name), what)


def unused(names: Iterable[str]) -> tuple[str, ...]:
    """Return the variables that none of these claims uses."""
    used = {variable for name in names for variable in CLAIMS[name].uses}
    return UNUSED + tuple(variable for variable in RARELY_USED if variable not in used)


def write(solutions: Solutions, path: str | Path, table: str | Path) -> None:
    """Judge the claims of a scene; write its whole dataset with them, and a Markdown text of them.

    Parameters
    ----------
    solutions : Solutions
        The solved scene, which lists the claims with their studies.
    path, table : path
        The netCDF file and the Markdown file.

    """
    # The import of xarray is not needed to check the names of claims.
    from weier.pipeline.gather import describe_again, gather, read_study
    from weier.pipeline.products import has_variables_of, inputs_of_data, mark

    # Only the studies of claims are read into memory, each once.
    wanted = solutions.scene.claims.items()
    without = unused(solutions.scene.claims)
    cases = cache(lambda study: Study.of(read_study(solutions, study, without)).cases)
    judged = {claim: _judge(claim, chain.from_iterable(map(cases, studies))) for claim, studies in wanted}
    step, inputs = "checked against the paper" if judged else "gathered", inputs_of_data(solutions)
    if has_variables_of(path, inputs) and not source_date():
        describe_again(solutions.scene, path, step, inputs)
    else:
        gather(solutions, path, step, report.to_dataset(judged), inputs)
    write_text(table, f"{report.to_markdown(solutions.scene.title, judged)}\n<!-- {mark(inputs)} -->\n")


def evaluate(name: str, studies: Iterable[xr.Dataset]) -> Judgement:
    """Judge a claim on these studies; a case of several studies counts once."""
    return _judge(name, chain.from_iterable(Study.of(study).cases for study in studies))


def _judge(name: str, cases: Iterable[Case]) -> Judgement:
    distinct = {str(case["key"]): case for case in cases}
    return judge(CLAIMS[name], list(distinct.values()))
