"""Every measurement is a command, most of which write and print a page of one form."""

import re
from pathlib import Path

import click
import numpy as np
from click.testing import CliRunner

from benchmarks.__main__ import NAMES as BENCHMARKS
from weier.accuracy.__main__ import main
from weier.accuracy.measurement import Measurements, measurement
from weier.data import provenance


@measurement("A title")
@click.option("--count", default=3, help="Of lines.")
@click.option("--seed", default=lambda: 7, help="Of the draws.")
def toy(count: int, seed: int) -> list[str]:
    """Count lines.

    In a second paragraph.
    """
    return [f"{count} of {seed}", "| a table |"]


def test_a_page_has_what_explains_it_its_tables_and_how_it_was_made(tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    found = CliRunner().invoke(toy, ["--count", "4", "--output", str(tmp_path / "new" / "page.md")])
    assert found.exit_code == 0, found.output
    page = (tmp_path / "new" / "page.md").read_text()
    assert found.output == page
    start, made = page.rsplit("\n\n", 1)
    assert start == "# A title\n\nCount lines.\n\nIn a second paragraph.\n\n4 of 7\n\n| a table |"
    assert made.startswith("Made by `accuracy --count 4 --seed 7` on 1970-01-01T00:00:00")
    assert f"weier {provenance.VERSION}, python 3." in made
    assert f"numpy {np.__version__}" in made
    assert "In a second paragraph." in CliRunner().invoke(toy, ["--help"]).output


def test_a_page_that_cannot_be_written_is_refused_before_anything_is_measured(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = CliRunner().invoke(main, ["coverage", "--output", str(tmp_path)])
    assert found.exit_code == 1
    assert "cannot be written (it is a folder): name another file" in found.output
    found = CliRunner().invoke(main, ["tradeoff", "--scene", "none.yaml"])
    assert found.exit_code == 1
    assert found.output == "Error: there is no file none.yaml\n"
    assert list(tmp_path.iterdir()) == []


def test_every_command_of_a_page_exists():
    """In each page and module, with its options."""
    pages = [*Path("docs").rglob("*.[mr]*"), *Path("weier").rglob("*.py"), Path("README.md")]
    text = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    commands = set(re.findall(r"python -m (weier\.accuracy|benchmarks) (\w+)((?: --\w+)?)", text))
    assert len(commands) > 10
    groups = {"weier.accuracy": main, "benchmarks": Measurements("benchmarks", BENCHMARKS, "")}
    for package, name, option in commands - {("weier.accuracy", "NAME", "")}:
        found = groups[package].get_command(click.Context(main), name)
        assert found is not None, f"python -m {package} {name}"
        assert {option.strip()} <= {"", *(each for parameter in found.params for each in parameter.opts)}
