"""Every command with its optional arguments left out, also one that is new."""

from __future__ import annotations

import shutil
from importlib import import_module

import pytest

import weier
from tests.scenes import scene_in, solve_scene
from weier.cli import cli
from weier.digests import numerics
from weier.figures import draw
from weier.pipeline import claims
from weier.pipeline.products import made_of

SCENE = """
title: test
loads: [0.1, 1.0]
methods: [demelio]
studies: {one: {product: {D: 1.25, gamma: 2, m: 1}}}
figures: {compliance: {draw: compliance, studies: [one]}}
claims: {}
"""
# Not from its package, a function of which has this name.
measurement = import_module("weier.accuracy.extremes.measurement")
# Values of required arguments by their names; a name that is none of a file stands for one to write.
REQUIRED = {
    "scene_file": "scene.yaml",
    "what": "all",
    "group": "closed_form",
    "number": "0",
    "count": "1",
    "numerics": numerics(),
    "folder": "curves",
    "store": "curves",
    "drafts": "drafts",
    "scenes": "scene.yaml",
    "contact": "contact.nc",
    "files": "drawn/contact.nc",
    "kind": "work_precision",
    "data": "new.nc",
    "path": "new.nc",
}
# What is no argument, and needed: a profile.
SERIES = ["-D", "1.25", "--gamma", "2", "-m", "1"]
NEEDED = {"solve": SERIES, "plot": SERIES}
# What can be left out of a command line, but not of what it does.
REFUSED = {
    "report": "Error: a report needs the two bodies, by --si, and the mean pressures, by --pressures",
    "draw": "weier: the figure work_precision is drawn from the file of `python -m weier.accuracy tradeoff`",
}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """The folder of a scene that the pipeline has solved, gathered and drawn."""
    folder = tmp_path_factory.mktemp("solved")
    loaded = scene_in(folder, SCENE, weier.load_scene)
    solutions = solve_scene(loaded, folder / "curves")
    stamp = folder / ".made_of/compliance" / made_of(solutions, "compliance")
    stamp.mkdir(parents=True)
    claims.write(solutions, folder / "contact.nc", folder / "claims.md")
    with weier.open_dataset(folder / "contact.nc") as data:
        draw(loaded.figure("compliance"), [data.load()], folder / "figures/compliance.png")
    return folder


@pytest.mark.parametrize("name", cli.commands)
def test_a_command_runs_with_its_optional_arguments_left_out(run, solved, tmp_path, monkeypatch, name):
    """Or refuses that in a sentence of its own."""
    shutil.copytree(solved, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    required = [parameter.name for parameter in cli.commands[name].params if parameter.required]
    known = REQUIRED | {"stamps": str(next(tmp_path.glob(".made_of/*/*")))}
    values = [known[argument] for argument in required]
    code, out, err = run(name, *NEEDED.get(name, []), *values)
    if name in REFUSED:
        assert code != 0
        assert err.splitlines()[-1] == REFUSED[name]
    else:
        assert code == 0, err
        assert out or err
        assert all((tmp_path / value).stat().st_size > 0 for value in values if value.startswith("new"))
