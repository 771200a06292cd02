"""The command line: one sentence and a non-zero exit for what is wrong, and nothing written."""

import re
import subprocess
import sys

import pytest

from weier.__main__ import cli

SCENE = """
title: test
loads: [0.1]
methods: [demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
"""


def weier(*arguments):
    return subprocess.run([sys.executable, "-m", "weier", *map(str, arguments)], capture_output=True, text=True)


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE)
    return path


def test_a_batch_becomes_two_files(scene_file, tmp_path):
    done = weier("batch", scene_file, "one-0", tmp_path / "data.nc", tmp_path / "cost.nc")
    assert done.returncode == 0
    assert "case 1/1: D = 1.25, gamma = 5, m = 2" in done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"test.yaml", "data.nc", "cost.nc"}


@pytest.mark.parametrize("text", [SCENE.replace("loads", "lods"), SCENE.replace("1.25", "2.25"), "{"])
def test_a_bad_scene_is_one_sentence(scene_file, tmp_path, text):
    scene_file.write_text(text)
    done = weier("batch", scene_file, "one-0", tmp_path / "data.nc", tmp_path / "cost.nc")
    assert done.returncode == 1
    assert done.stderr.startswith(f"weier: {scene_file}")
    assert done.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["test.yaml"]


def test_a_truncated_file_is_one_sentence(scene_file, tmp_path):
    whole, cost, part = tmp_path / "data.nc", tmp_path / "cost.nc", tmp_path / "bounded.nc"
    weier("batch", scene_file, "one-0", whole, cost)
    whole.write_bytes(whole.read_bytes()[:3000])
    done = weier("bounds", whole, part)
    assert done.returncode == 1
    assert "not a whole netCDF file: delete it" in done.stderr
    assert done.stderr.count("\n") == 1
    assert not part.exists()


def test_an_unknown_batch_is_refused(scene_file, tmp_path):
    done = weier("batch", scene_file, "two-0", tmp_path / "data.nc", tmp_path / "cost.nc")
    assert done.returncode == 1
    assert "no batch 'two-0'" in done.stderr


@pytest.mark.parametrize("arguments", [("gather", "two", "a.nc", "."), ("figure", "two", "a.png")])
def test_an_unknown_study_or_figure_is_refused(scene_file, arguments):
    command, *others = arguments
    done = weier(command, scene_file, *others)
    assert done.returncode == 1
    assert "has no" in done.stderr
    assert "'two'" in done.stderr


def test_help_names_every_command():
    done = weier("--help")
    assert done.returncode == 0
    commands = done.stdout.partition("Commands:")[2].partition("Exit codes")[0]
    assert "..." not in commands  # a line says it all
    assert set(re.findall(r"^  (\w+) +\S", commands, re.M)) == set(cli.commands)


@pytest.mark.parametrize("name", ["solve", "plot", "plan"])
def test_the_first_help_shows_the_commands_for_one_profile(name):
    assert f"weier {name} -D 1.25 --gamma 5 -m 3" in weier("--help").stdout
