"""The documentation: its examples are true, and it builds without a warning."""

import doctest
import re
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from weier import scene


def test_the_tutorial_is_true():
    plt.switch_backend("agg")  # no windows
    result = doctest.testfile(str(Path("docs/tutorial.rst").resolve()), module_relative=False)
    plt.close("all")
    assert result.attempted > 20
    assert result.failed == 0


def test_the_first_lines_of_the_readme_run(capsys):
    (code, *_) = re.findall(r"```python\n(.*?)```", Path("README.md").read_text(encoding="utf-8"), re.S)
    exec(compile(code, "README.md", "exec"), {})
    compliance, resistance = re.findall(r"\[[^]]+\]", capsys.readouterr().out)
    assert len(compliance[1:-1].split()) == len(resistance[1:-1].split()) == 3


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The pages, with the same picture for all figures: the real ones are drawn from minutes of work."""
    folder = tmp_path_factory.mktemp("site")
    figures = scene.load("config/scenes/paper.yaml").figures
    for name in figures:
        shutil.copy("docs/figure_3.png", folder / f"{name}.png")
    command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet"]
    settings = ["-D", f"scene_figures={folder}", "-d", folder / "doctrees"]
    done = subprocess.run([*command, *settings, "docs", folder / "html"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "html"


def page(site, name):
    return (site / f"{name}.html").read_text(encoding="utf-8")


def test_every_page_is_reached_from_the_first(site):
    pages = {path.stem for suffix in ("rst", "md") for path in Path("docs").glob(f"*.{suffix}")}
    linked = set(re.findall(r'href="(\w+)\.html', page(site, "index")))
    assert pages - {"index"} <= linked


def test_figures_and_captions_of_the_scene_are_there(site):
    text = page(site, "gallery")
    assert text.count("<figcaption>") == len(scene.load("config/scenes/paper.yaml").figures)
    assert "<strong>Figure 7. </strong>What further terms change" in text


def test_the_tutorial_drew_its_figures(site):
    drawn = re.findall(r'<img[^>]*src="(_images/tutorial[^"]*)"', page(site, "tutorial"))
    assert len(drawn) == 2
    assert all((site / path).stat().st_size > 10_000 for path in drawn)


def test_formulae_need_no_network(site):
    for path in site.glob("*.html"):
        assert re.findall(r'<(?:script|img)[^>]*src="(?:https?:)?//', path.read_text(encoding="utf-8")) == []
    assert page(site, "interface").count("<math") > 20


def test_docstrings_stay_as_they_are(site):
    text = re.sub(r"<[^>]+>", "", page(site, "interface"))
    assert "(13) prints 1/R; this is R" in text
    assert "Sum of all g_n, in g_0: the compliance at full contact (22)." in text
    assert "p_0* = 2 pi M g_0/lambda_0" in text
