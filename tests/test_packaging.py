"""What is built from the checkout: a source archive with all of the project, a wheel with all of the package."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from weier.data.provenance import VERSION


def run(*command, cwd=None):
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(list(map(str, command)), cwd=cwd, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def tracked():
    """All files of the project; others that stand beside them, as logs, are none of its own."""
    if not Path(".git").exists():  # in the source archive, whose tests run, too
        pytest.skip("only a clone knows its files")
    listed = run("git", "ls-files").splitlines()
    return {name for name in listed if Path(name).is_file()}


@pytest.fixture(scope="module")
def built(tracked, tmp_path_factory):
    """Archive and wheel of a copy: setuptools would take up what earlier builds left beside the checkout's files."""
    folder = tmp_path_factory.mktemp("packaging")
    for name in tracked:
        (folder / "copy" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(name, folder / "copy" / name)
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, folder / "copy")
    return folder


def test_the_archive_holds_the_whole_project_and_the_wheel_the_package(built, tracked):
    with tarfile.open(next(built.glob("*.tar.gz"))) as archive:
        names = {member.name.partition("/")[2] for member in archive if member.isfile()}
    made = {name for name in names if name.startswith("weier.egg-info/")} | {"PKG-INFO", "setup.cfg"}
    assert names - made == {name for name in tracked if not name.startswith(".")}
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        names = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert names == {name for name in tracked if name.startswith("weier/")}


def test_conda_gets_the_versions_that_are_locked():
    """And the package in the version of the workflow: rules/environment.yaml is written by hand."""
    python, *_, pip = yaml.safe_load(Path("rules/environment.yaml").read_text())["dependencies"]
    version = python.removeprefix("python=")
    markers = {"python_version": version, "python_full_version": f"{version}.0"}
    lines = re.findall(r"^\w.*==[^\\\n]*", Path("requirements/run.txt").read_text(), re.M)
    locked = {
        canonicalize_name(requirement.name): str(requirement.specifier)
        for requirement in map(Requirement, lines)
        if requirement.marker is None or requirement.marker.evaluate(markers)
    }
    assert {
        canonicalize_name(requirement.name): str(requirement.specifier)
        for requirement in map(Requirement, pip["pip"])
    } == locked | {"weier": f"=={VERSION}"}
    assert f'VERSION = "{VERSION}"' in Path("Snakefile").read_text()


@pytest.mark.slow
def test_the_installed_wheel_passes_the_tests_of_the_archive(built):
    """In a fresh environment, without the package beside the tests: it is the installed one that passes them."""
    with tarfile.open(next(built.glob("*.tar.gz"))) as archive:
        archive.extractall(built, filter="data")
    (project,) = (path for path in built.iterdir() if (path / "PKG-INFO").exists())
    shutil.rmtree(project / "weier")
    run(sys.executable, "-m", "venv", built / "environment")
    python = built / "environment/bin/python"
    run(python, "-m", "pip", "install", "--quiet", "--require-hashes", "-r", project / "requirements/dev.txt")
    run(python, "-m", "pip", "install", "--quiet", "--no-deps", next(built.glob("*.whl")))
    assert Path(run(python, "-c", "import weier; print(weier.__file__)", cwd=project)).is_relative_to(built)
    path = f"{python.parent}{os.pathsep}{os.environ['PATH']}"  # for the tests that call snakemake
    run("env", f"PATH={path}", python, "-m", "pytest", "-q", "--ignore=tests/test_packaging.py", cwd=project)
