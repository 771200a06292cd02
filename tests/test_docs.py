"""The documentation: its examples are true, and it builds without a warning."""

import doctest
import re
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

import weier
from weier import scene
from weier.data import dataset
from weier.pipeline import batch


def test_the_tutorial_is_true():
    plt.switch_backend("agg")  # no windows
    result = doctest.testfile(str(Path("docs/tutorial.rst").resolve()), module_relative=False)
    plt.close("all")
    assert result.attempted > 20
    assert result.failed == 0


DATA = """
title: Two of the paper's profiles
loads: [0.01, 0.1, 1.0]
methods: [demelio, layer]
studies:
  one: {product: {D: [1.25, 1.5], gamma: 5, m: [2, 3]}}
"""


def test_the_python_of_the_readme_runs(capsys, tmp_path, monkeypatch):
    """On a few curves in the place of the paper's; what comes of them is right."""
    text = Path("README.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (path,) = set(re.findall(r'"(results/\S*\.nc)"', text))
    Path("scene.yaml").write_text(DATA)
    loaded = scene.load("scene.yaml")
    dataset.write(batch.solve_batch(loaded, loaded.studies["one"])[0], path, loaded.title)

    capsys.readouterr()
    names = {}  # of one reader, who goes from top to bottom

    def said(code):
        exec(compile(code, "README.md", "exec"), names)
        return capsys.readouterr().out

    solved, *opened = [said(code) for code in re.findall(r"```python\n(.*?)```", text, re.S)]
    compliance, resistance = (np.fromstring(row, sep=" ") for row in re.findall(r"\[([^]]+)\]", solved))
    exact = weier.solve(weier.Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), loaded.loads, "patches")
    assert compliance == pytest.approx(exact.compliance.values, abs=1e-3)
    assert resistance == pytest.approx(exact.resistance.values, rel=0.1)
    layer = weier.solve(weier.Profile(1.5, 5, 3), loaded.loads, "layer").compliance.values
    assert len(opened) == 2
    for printed in opened:
        last = re.findall(r"^[\d. ]+ ([\d.]+)$", printed, re.M)  # of each row
        assert [float(number) for number in last] == pytest.approx(layer, rel=1e-4)


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


def test_pictures_have_words_and_numbers_stay_whole(site):
    assert 'alt="Figure 1: The profiles over two of their longest wavelengths"' in page(site, "gallery")
    assert re.search(r'<td class="number"><p>6\.7e-04</p></td>', page(site, "benchmark"))
    assert re.search(r"<td><p>tamaas</p></td>", page(site, "benchmark"))


def test_the_tutorial_drew_its_figures(site):
    drawn = re.findall(r'<img[^>]*src="(_images/tutorial[^"]*)"', page(site, "tutorial"))
    assert len(drawn) == 2
    assert all((site / path).stat().st_size > 10_000 for path in drawn)


def test_formulae_need_no_network(site):
    for path in site.glob("*.html"):
        assert re.findall(r'<(?:script|img)[^>]*src="(?:https?:)?//', path.read_text(encoding="utf-8")) == []
    assert page(site, "interface").count("<math") > 20


def test_all_that_is_public_is_described(site):
    text = page(site, "interface")
    public = {f"weier.{name}" for name in weier.__all__ if not name.startswith("_")}
    public |= {
        "weier.methods.planned.plan.Plan",
        "weier.methods.planned.segment.Part",
        "weier.pipeline.plan.ScenePlan",
        "weier.scene.Scene",
        "weier.scene.load",
    }
    public |= {
        "weier.methods.planned.curve.curve",
        "weier.methods.hybrid.solver",
        "weier.accuracy.convergence.convergence",
    }
    assert {name for name in public if f'id="{name}"' not in text} == set()


def test_what_a_class_holds_is_a_list(site):
    text = re.sub(r"</?(?:code|span)[^>]*>", "", page(site, "interface"))
    assert "<li><p>planned_method, planned_terms, planned_points : what was taken at each load" in text
    assert re.search(r"<li><p>compliance_lower, compliance_upper : bounds on h[^<]*\sboundary elements", text)


def test_docstrings_stay_as_they_are(site):
    text = re.sub(r"<[^>]+>", "", page(site, "interface"))
    assert "(13) prints 1/R; this is R" in text
    assert "Sum of all g_n, in g_0: the compliance at full contact (22)." in text
    assert "p_0* = 2 pi M g_0/lambda_0" in text
