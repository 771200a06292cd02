"""The documentation: its examples are true, and it builds without a warning."""

import doctest
import pkgutil
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

import weier
from tests.scenes import scene_in, solve_scene
from weier import scene
from weier.api import batch
from weier.data import variables
from weier.data.variables import Check
from weier.methods import registry
from weier.pipeline import claims
from weier.pipeline.claims import paper
from weier.pipeline.claims.claim import cases_of, judge


@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("index", 5),
        ("one_load", 50),
        pytest.param("measured", 20, marks=pytest.mark.second_attempt),
        ("first_day", 20),
        ("tutorial", 20),
    ],
)
def test_the_pages_that_run_are_true(name, least):
    plt.switch_backend("agg")  # no windows
    result = doctest.testfile(str(Path(f"docs/{name}.rst").resolve()), module_relative=False)
    plt.close("all")
    assert result.attempted > least
    assert result.failed == 0


DATA = """
title: Two of the paper's profiles
loads: [0.01, 0.1, 1.0]
methods: [demelio, layer]
studies:
  one: {product: {D: [1.25, 1.5], gamma: 5, m: [2, 3]}}
"""
PAPER = (
    DATA
    + """
  rough: {product: {D: 1.5, gamma: 5, m: 3, phases: 1.0}}
  rough_ensemble: {product: {D: 1.5, gamma: 5, m: 3, seed: [0, 1]}}
"""
)


def test_the_python_of_the_readme_runs(capsys, tmp_path, monkeypatch):
    """On a few curves in the place of the paper's; what comes of them is right."""
    text = Path("README.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (path,) = set(re.findall(r'"(results/\S*\.nc)"', text))
    loaded = scene_in(tmp_path, PAPER)
    claims.write(solve_scene(loaded, Path("curves")), path, "claims.md")

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
    layer = weier.solve(weier.Profile(1.5, 5, 3), loaded.loads, "layer")
    assert len(opened) == 1
    for printed in opened:
        last = re.findall(r" ([\d.]+)$", printed, re.M)  # of each row
        assert [float(number) for number in last] == pytest.approx(layer.compliance.values, rel=1e-4)
    assert "rough: D = 1.5, gamma = 5, m = 3, phases = 1" in opened[0]


def test_what_python_offers_is_what_is_public():
    assert dir(weier) == sorted(weier.__all__)


def examples(language):
    """The code of CONTRIBUTING.md in one language."""
    return re.findall(rf"```{language}\n(.*?)```", Path("CONTRIBUTING.md").read_text(encoding="utf-8"), re.S)


def test_the_method_of_contributing_is_solved_once_it_is_listed(monkeypatch):
    (code,) = (code for code in examples("python") if "METHOD = " in code)
    names = {}
    exec(compile(code, "CONTRIBUTING.md", "exec"), names)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, names["METHOD"]))
    curve = weier.solve(weier.Profile(1.25, 5, 3), [0.5], names["METHOD"].name)
    assert curve.compliance.item() == pytest.approx(0.5 * (1 + np.log(2)), rel=1e-15)  # (12)


@pytest.fixture
def two_profiles(tmp_path):
    """A study of two curves by several methods."""
    loaded = scene_in(tmp_path, DATA.replace("[demelio, layer]", "[demelio, patches]"))
    return batch.solve_batch(loaded.studies["one"], loaded.loads)


def test_the_figure_of_contributing_is_drawn(two_profiles):
    (code,) = (code for code in examples("python") if "def draw(" in code)
    names = {}
    exec(compile(code, "CONTRIBUTING.md", "exec"), names)
    figure = names["draw"]([two_profiles], "")
    assert [axes.get_xscale() for axes in figure.axes] == ["linear"] * two_profiles.sizes["case"]
    assert {"Demelio", "contact patches"} <= {
        text.get_text() for legend in figure.legends for text in legend.get_texts()
    }


def test_the_claim_of_contributing_is_measured(two_profiles):
    (code,) = (code for code in examples("python") if "@claim" in code)
    names = dict(vars(paper))
    exec(compile(code, "CONTRIBUTING.md", "exec"), names)
    largest = two_profiles["resistance"].sel(solution_method="patches").diff("mean_pressure").max("mean_pressure")
    judged = judge(
        names["resistance_falls"],
        *(cases_of(two_profiles.isel(mean_pressure=slice(None, None, step))) for step in (1, 2)),
    )
    assert judged.decisive.number.value == pytest.approx(largest.max().item())
    assert judged.decisive.number.quantity.startswith("largest change of the numerical resistance")
    assert judged.outcome == Check.not_decided  # too few profiles


PAGES = sorted(path for suffix in ("md", "rst") for path in Path("docs").rglob(f"*.{suffix}"))
SOURCES = [path for folder in ("weier", "benchmarks") for path in sorted(Path(folder).rglob("*.py"))]


def test_the_names_in_the_glossary_and_the_notation_exist():
    profile = weier.Profile(1.25, 5, 2)
    fields = weier.fields(profile, 0.5)
    copper = weier.Interface(
        mu_1=4e10, mu_2=4e10, nu_1=0.3, nu_2=0.3, rho_1=2e-8, rho_2=2e-8, lambda_0=1e-3, g_0=1e-6
    )
    known = {f"data: `{name}`" for name in variables.VARIABLES}
    known |= {f"fields: `{name}`" for name in (*fields.variables, *fields.attrs)}
    known |= {f"`{owner}.{name}`" for owner, of in (("Profile", profile), ("Interface", copper)) for name in dir(of)}
    rows = [line for line in Path("docs/notation.md").read_text(encoding="utf-8").splitlines() if line[:3] == "| $"]
    named = re.findall(r"(?:data: |fields: )`\w+`|`(?:Profile|Interface)\.\w+`", "\n".join(rows))
    assert len(named) > 30
    assert set(named) <= known
    glossary = re.findall(r"`(weier(?:\.\w+)+)`", Path("docs/glossary.md").read_text(encoding="utf-8"))
    assert len(glossary) > 10
    for name in [*glossary, *re.findall(r"`(weier(?:\.\w+)+)`", "\n".join(rows))]:
        pkgutil.resolve_name(name)


def test_files_and_sections_that_pages_and_sources_name_exist():
    """In code a section is `docs/PAGE.md, "Section"`."""
    lacking = []
    for path in [*PAGES, *SOURCES]:
        text = re.sub(r"\n\s*(?:#\s*)?", " ", path.read_text(encoding="utf-8"))  # also across lines of a comment
        folders = "docs" if path in SOURCES else "weier|tests|config|benchmarks|docs|profiles|rules"
        files = re.findall(rf"(?:`|\b)((?:{folders})/[\w/.]*\.(?:md|rst|py|yaml))\b", text)
        lacking += [(path, name) for name in files if not Path(name).exists()]
        for name, section in re.findall(r'(docs/\w+\.(?:md|rst)), \(?"([A-Z][^"\\]{2,60})"', text):
            if not re.search(rf"^(#+ )?{re.escape(section)}$", Path(name).read_text(encoding="utf-8"), re.M):
                lacking.append((path, f"{name}, {section}"))
    assert lacking == []


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The pages, with the same picture for all figures: the real ones are drawn from minutes of work."""
    folder = tmp_path_factory.mktemp("site")
    figures = scene.load("config/scenes/paper.yaml").figures
    for name in figures:
        shutil.copy("docs/message.png", folder / f"{name}.png")
    command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet"]
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sys, "path", sys.path[:])  # to which it adds folders
        configured = runpy.run_path("docs/conf.py")["extensions"]
    extensions = [name for name in configured if name != "sphinx.ext.viewcode"] + ["tests.plots"]  # without sources
    settings = ["-D", f"scene_figures={folder}", "-D", f"extensions={','.join(extensions)}"]
    command += [*settings, "-d", folder / "doctrees", "docs", folder / "html"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "html"


def page(site, name):
    return (site / f"{name}.html").read_text(encoding="utf-8")


def interface(site):
    """All pages of the interface, which has one for each area."""
    return "".join(path.read_text(encoding="utf-8") for path in sorted((site / "api").glob("*.html")))


def test_formulae_need_no_network(site):
    """The script that draws them is a part of the site, and no page requests files of another server."""
    fetched = [
        name
        for path in site.rglob("*.html")
        for name in re.findall(r'<(?:script|img|link)[^>]*(?:src|href)="([^"]*)"', path.read_text(encoding="utf-8"))
    ]
    assert [name for name in fetched if re.match(r"(https?:)?//", name)] == []
    assert any(name.partition("?")[0].endswith("mathjax/tex-chtml.js") for name in fetched)
    assert (site / "_static/mathjax/tex-chtml.js").stat().st_size > 10**5
    assert interface(site).count('class="math') > 20
    assert "\\begin{cases}" in page(site, "api/estimates")


def test_the_glossary_has_all_variables_and_public_names(site):
    named = set(re.findall(r'<span class="pre">([\w.]+)</span>', page(site, "glossary")))
    public = {f"weier.{name}" for name in weier.__all__ if not name.startswith("_")}
    assert (public | set(variables.VARIABLES)) - named == set()
