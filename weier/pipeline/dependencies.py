"""What in the program each step of the pipeline depends on, as digests that Snakemake compares with the last ones.

Every step asks the registry for its methods, and the registry lists all of them. If the digests followed this list, a
scene would be solved again after a change of a method that it does not use, or of a cost model that only plans use.
So the list and the default that is chosen from it are left out, and what a step uses of the methods is added: for a
batch the functions that it calls, for other steps the label and the style of each method and whether it is numerical.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from weier.kernels.definitions import definitions, modules_of
from weier.kernels.sources import PACKAGE
from weier.methods import registry
from weier.methods.registry import find_method
from weier.pipeline.digests import digest, digest_of_definitions, texts_of_modules

BATCH_FUNCTIONS = ("weier.pipeline.batch.solve_batch", "weier.data.dataset.write")
STUDY = "weier.pipeline.gather.read_study"
LISTS_NOT_FOLLOWED = ("weier.methods.registry.METHODS", "weier.methods.registry.DEFAULT")


def batch_digest(methods: Iterable[str]) -> str:
    """A digest of all that the numbers of a batch by these methods depend on."""
    return _batch_digest(tuple(sorted(methods)))


@cache
def _batch_digest(methods: tuple[str, ...]) -> str:
    names, without = _of_batch(methods)
    return digest_of_definitions(*names, without=without)


def batch_definitions(methods: Iterable[str]) -> dict[str, str]:
    """The text of all that the numbers of a batch by these methods depend on, by name."""
    names, without = _of_batch(methods)
    return definitions(*names, without=without)


def _of_batch(methods: Iterable[str]) -> tuple[Collection[str], Collection[str]]:
    """The names that the numbers of a batch begin with, and those that are not followed."""
    used = [find_method(name) for name in methods]
    if any(method.runs_others for method in used):
        return BATCH_FUNCTIONS, ()
    functions = [each for method in used for each in (method.solve, method.applies, method.solution_error) if each]
    own = [name for each in functions for name in _names(each)]
    return (*BATCH_FUNCTIONS, *own), LISTS_NOT_FOLLOWED


def _names(function: Callable[..., Any]) -> Iterator[str]:
    """The name of a function, or of the one that made it, and those of the functions it was made with."""
    defined = function if hasattr(function, "__qualname__") else type(function)  # an instance that can be called
    yield f"{defined.__module__}.{defined.__qualname__.partition('.')[0]}"
    for cell in getattr(function, "__closure__", None) or ():
        if callable(cell.cell_contents):
            yield from _names(cell.cell_contents)


@cache
def figure_digest(kind: str) -> str:
    """A digest of all that a kind of figure depends on."""
    return _step_digest("weier.figures.draw", f"weier.figures.{kind}", STUDY)


@cache
def claims_digest() -> str:
    """A digest of all that the claims and the dataset of a scene depend on."""
    return _step_digest(*modules_of("weier.pipeline.claims"))


@cache
def page_digest() -> str:
    """A digest of all that a page depends on, among it every figure, whose module holds its caption."""
    scripts = sorted((PACKAGE / "figures").rglob("*.js"))
    return _step_digest(*modules_of("weier.figures"), files=scripts)


def program_digest(name: str) -> str:
    """A digest of all that a module or the modules of a folder depend on, all methods among it."""
    return digest_of_definitions(name, *modules_of(name))


def docs_digest() -> str:
    """A digest of the text of all modules, whose docstrings the documentation shows."""
    return digest(texts_of_modules())


def _step_digest(*names: str, files: Iterable[Path] = ()) -> str:
    """A digest of what a step without solving depends on: definitions, methods as figures show them, and files."""
    shown = {each.name: repr((each.label, each.numerical, each.style)) for each in registry.METHODS}
    texts = {path.name: path.read_text(encoding="utf-8") for path in files}
    return digest({"definitions": digest_of_definitions(*names, without=LISTS_NOT_FOLLOWED)} | shown | texts)
