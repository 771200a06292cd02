"""Every measurement is a command, most of which print a page of one form."""

import re
from pathlib import Path

import click
from click.testing import CliRunner

from benchmarks.__main__ import NAMES as BENCHMARKS
from weier.accuracy.__main__ import main
from weier.accuracy.measurement import commands, measurement
from weier.data import provenance


@measurement("A title")
@click.option("--count", default=3, help="Of lines.")
def toy(count: int) -> list[str]:
    """Count lines.

    In a second paragraph.
    """
    return [f"{count} of 7", "| a table |"]


def test_a_page_has_what_explains_it_its_tables_and_how_it_was_made(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    monkeypatch.setattr("sys.argv", ["accuracy", "toy", "--count", "4"])
    found = CliRunner().invoke(toy, ["--count", "4"], prog_name="python -m toys toy")
    assert found.exit_code == 0, found.output
    start, made = found.output.rsplit("\n\n", 1)
    assert start == "# A title\n\nCount lines.\n\nIn a second paragraph.\n\n4 of 7\n\n| a table |"
    assert made.startswith("Made by `python -m toys toy --count 4` on 1970-01-01T00:00:00")
    assert provenance.origin() in made
    assert "In a second paragraph." in CliRunner().invoke(toy, ["--help"]).output


def test_a_scene_that_is_not_there_ends_in_one_sentence():
    found = CliRunner().invoke(main, ["tradeoff", "--scene", "none.yaml"])
    assert found.exit_code == 1
    assert found.output.startswith("Error: there is no file none.yaml")
    assert len(found.output.splitlines()) == 1


def test_every_command_of_a_page_exists():
    """In each page and module, with its options."""
    pages = [*Path("docs").rglob("*.[mr]*"), *Path("weier").rglob("*.py"), Path("README.md")]
    text = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    named = set(re.findall(r"python -m (weier\.accuracy|benchmarks) (\w+)((?: --\w+)?)", text))
    assert len(named) > 10
    groups = {"weier.accuracy": main, "benchmarks": commands("benchmarks", BENCHMARKS, "")}
    for package, name, option in named - {("weier.accuracy", "NAME", "")}:
        found = groups[package].get_command(click.Context(main), name)
        assert found is not None, f"python -m {package} {name}"
        assert {option.strip()} <= {"", *(each for parameter in found.params for each in parameter.opts)}
