"""What a job depends on: all that it calls, and neither other methods nor what only plans ask."""

import os
import subprocess
import sys

import pytest

from weier import scene
from weier.methods import registry
from weier.methods.registry import PLANNED
from weier.pipeline.dependencies import batch_definitions, batch_digest, claims_digest, figure_digest, page_digest

SCENE = """
title: test
loads: [0.01, 0.1, 2.0]
methods: [METHOD]
studies: {one: {product: {D: 1.5, gamma: 2, m: [1, 2, .inf], phases: 1.0}}}
"""

# As plain Python, which shows what is called; each method in a process that remembers nothing of the others.
PROGRAM = """
import os, sys, threading
from pathlib import Path
from weier import scene
from weier.data import dataset
from weier.kernels.sources import PACKAGE
from weier.pipeline.batch import solve_batch

called = {}

def note(frame, *_):
    called[id(frame.f_code)] = frame.f_code

def names():
    for code in called.values():
        path = Path(code.co_filename)
        if PACKAGE in path.parents:
            module = path.relative_to(PACKAGE.parent).with_suffix("").parts
            module = module[:-1] if module[-1] == "__init__" else module
            yield ".".join((*module, code.co_qualname.partition(".")[0]))

for path in map(Path, sys.argv[1:]):
    if os.fork() == 0:
        loaded = scene.load(path)
        threading.settrace(note)  # also where cases are solved
        sys.settrace(note)
        data, _ = solve_batch(loaded, loaded.cases.values())
        dataset.write(data, path.with_suffix(".nc"), "test")
        sys.settrace(None)
        path.with_suffix(".txt").write_text("\\n".join(names()))
        os._exit(0)
    os.wait()
"""


@pytest.fixture(scope="module")
def called(tmp_path_factory):
    """The functions and classes that a batch calls, by its method."""
    folder = tmp_path_factory.mktemp("called")
    for method in registry.names():
        (folder / f"{method}.yaml").write_text(SCENE.replace("METHOD", method))
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    scenes = [folder / f"{method}.yaml" for method in registry.names()]
    subprocess.run([sys.executable, "-c", PROGRAM, *scenes], env=environment, capture_output=True, check=True)
    return {path.stem: set(path.with_suffix(".txt").read_text().split()) for path in scenes}


@pytest.mark.parametrize("method", registry.names())
def test_a_batch_depends_on_every_function_that_it_calls(method, called):
    names = {name for name in called[method] if not name.endswith(("<lambda>", "<module>"))}
    assert "weier.methods.solve.solve_checked" in names
    assert names - batch_definitions([method]).keys() == set()


@pytest.mark.parametrize("method", [name for name in registry.names() if name != PLANNED])
def test_a_batch_without_plans_depends_on_no_cost(method):
    """Nor on what else only plans ask, whose constants are fitted again."""
    names = batch_definitions([method]).keys()
    words = ("methods.planned", ".candidates.", "error_model.seconds", "error_model.SECONDS", "CREST_LOAD")
    assert [name for name in names if any(word in name for word in words)] == []
    assert "weier.methods.bem.error_model.SECONDS_NODE" in batch_definitions([PLANNED])


def test_a_batch_depends_on_its_own_methods_only():
    names = batch_definitions(["demelio", "bem"]).keys()
    assert "weier.methods.demelio.compliance" in names
    assert "weier.methods.bem.error_model.COMPLIANCE" in names  # of the bounds
    others = ("archard", "layer", "hybrid", "patches", "planned")
    assert not any(name.startswith(f"weier.methods.{other}") for other in others for name in names)
    assert not any("figures" in name or "claims" in name for name in names)
    assert batch_digest(["demelio", "bem"]) == batch_digest(["bem", "demelio"]) != batch_digest(["bem"])


def test_each_step_has_a_digest_of_its_own():
    digests = [figure_digest("compliance"), figure_digest("resistance"), claims_digest(), page_digest()]
    assert len(set(digests)) == len(digests)


def test_the_look_of_a_method_is_of_the_figures_alone(monkeypatch):
    def digests():
        for cached in (figure_digest, page_digest):
            cached.cache_clear()
        return figure_digest("compliance"), page_digest(), batch_digest(["demelio"])

    figure, page, batch = digests()
    first = registry.METHODS[0]
    changed = type(first)(**{**first.__dict__, "label": "another"})
    monkeypatch.setattr(registry, "METHODS", (changed, *registry.METHODS[1:]))
    again = digests()
    monkeypatch.undo()
    digests()
    assert again[0] != figure
    assert again[1] != page
    assert again[2] == batch


def test_a_scene_tells_the_methods_of_a_batch(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace("METHOD", "demelio, layer"))
    assert scene.load(path).methods_of("one-0") == ("demelio", "layer")
