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
studies: {one: {product: {D: 1.5, gamma: 2, m: [1, 2, .inf], phase: 1.0}}}
"""

# As plain Python, which shows what is called.
PROGRAM = """
import sys
from pathlib import Path
from weier import scene
from weier.data import dataset
from weier.kernels.sources import PACKAGE
from weier.pipeline.batch import solve_batch

loaded = scene.load(sys.argv[1])
called = set()

def note(frame, *_):
    code = frame.f_code
    path = Path(code.co_filename)
    if PACKAGE in path.parents:
        module = path.relative_to(PACKAGE.parent).with_suffix("").parts
        module = module[:-1] if module[-1] == "__init__" else module
        called.add(".".join((*module, code.co_qualname.partition(".")[0])))

sys.setprofile(note)
data, _ = solve_batch(loaded, loaded.cases.values())
dataset.write(data, sys.argv[2], "test")
sys.setprofile(None)
print(*called, sep="\\n")
"""


@pytest.mark.parametrize("method", registry.names())
def test_a_batch_depends_on_every_function_that_it_calls(method, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace("METHOD", method))
    command = [sys.executable, "-c", PROGRAM, path, tmp_path / "data.nc"]
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    called = {name for name in done.stdout.split() if not name.endswith(("<lambda>", "<module>"))}
    assert called - batch_definitions([method]).keys() == set()


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
