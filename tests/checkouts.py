"""Copies of the checkout with a scene, and runs of Snakemake in them."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from weier.digests import PACKAGE


def copied(folder: Path, scene: str, *more: str) -> Path:
    """Copy the workflow and more folders, with a scene named test."""
    shutil.copytree(PACKAGE, folder / "weier")
    for name in ("config", "rules", *more):
        shutil.copytree(name, folder / name)
    shutil.copy("Snakefile", folder)
    (folder / "config/scenes/test.yaml").write_text(scene)
    return folder


def environment(**variables: str) -> dict[str, str]:
    """Plain Python takes seconds for few loads, compiling in a new folder a minute. One date makes bytes the same.

    Bytecode is kept in the copy, or each run would make it anew.
    """
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"NUMBA_DISABLE_JIT": "1", "SOURCE_DATE_EPOCH": "1000000000"} | variables


def snakemake(folder: Path, *arguments: object, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run Snakemake in a folder, with more variables in its environment; a run that hangs is an error."""
    command = [sys.executable, "-P", "-m", "snakemake", *map(str, arguments)]
    return subprocess.run(
        command, cwd=folder, env=environment(**variables), capture_output=True, text=True, timeout=900
    )
