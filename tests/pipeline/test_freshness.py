"""What must not pass as fresh, and what must not be solved again: five faults, each with its relatives."""

import shutil
import subprocess
import sys

import pytest

from tests.scenes import curves_in, scene_in
from weier import digests
from weier.data import bodies
from weier.data.variables import Status
from weier.digests import PACKAGE, numerics
from weier.methods import registry
from weier.pipeline import jobs
from weier.pipeline.jobs import solve
from weier.pipeline.products import DATA, PAGE, made_of, names_of
from weier.scene import case
from weier.surface.measured import trace as traces


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A copy of the package, which digests are of."""
    copy = shutil.copytree(PACKAGE, tmp_path / "weier", ignore=shutil.ignore_patterns("__pycache__", "page"))
    monkeypatch.setattr(digests, "PACKAGE", copy)
    return copy


# --- 1. Code that changes while a run works files no curve under the digest of the plan. ---


@pytest.mark.parametrize("module", ["methods/demelio.py", "scene/case.py", ""])
def test_code_that_changes_while_a_job_works_is_no_code_of_its_curves(tmp_path, package, monkeypatch, module):
    """Also another version of a package. What was appended before stays, and an undone edit leaves nothing behind."""
    curves = curves_in(scene_in(tmp_path, SCENE), tmp_path / "curves")
    own, done = jobs._row, []

    def edited(*given):
        done.append(given)
        if len(done) == 6 and module:
            (package / module).write_text((package / module).read_text() + "\nMORE = 1\n")
        elif len(done) == 6:
            monkeypatch.setattr(digests, "versions", lambda: "numpy 0")
        return own(*given)

    monkeypatch.setattr(jobs, "APPEND_SECONDS", 0)
    monkeypatch.setattr(jobs, "_row", edited)
    for _ in range(2):  # nor does a job begin that was planned before
        with pytest.raises(ValueError, match="the code of weier has changed since the plan: run snakemake again"):
            solve(curves.store.lacking(curves.parts_for()), curves.store, "test", lambda line: None)
    monkeypatch.undo()
    again = curves_in(curves.scene, curves.store.folder)
    assert (len(done), sum(len(part.keys) for part in again.store.lacking(again.parts_for()))) == (6, 12 - 5)


# --- 2. An edit that changes a number changes the numerics. 4. Words change nothing. ---

EDITS = [
    ("scene/case.py", 'random_phases(p["seed"])', 'random_phases(p["seed"] + 1)', True),
    ("surface/profile.py", "2 * np.pi, m)", "2 * np.pi, m)[::-1]", True),
    ("methods/bem/boundary_elements.py", "points_per_wave: int | None = None", "points_per_wave: int = 32", True),
    ("pipeline/store.py", "joined[(rows, ", "joined[(rows[::-1], ", True),
    ("surface/measured/trace.py", "\n\n\n", "\n\n\nMORE = 1\n\n\n", True),
    ("api/task.py", '"""A curve to solve', '"""One curve to solve', False),
    ("surface/profile.py", "\n\n\n", "\n\n\n# A comment.\n", False),
    ("pipeline/needed_curves.py", "method: str", "method: object", False),
    ("figures/many_curves.py", "\n\n\n", "\n\n\nMORE = 1\n\n\n", False),
]


@pytest.mark.parametrize(("module", "old", "new", "changes"), EDITS)
def test_the_numerics_change_with_what_may_change_a_number_alone(package, module, old, new, changes):
    before, text = numerics(), (package / module).read_text()
    assert old in text
    (package / module).write_text(text.replace(old, new, 1))
    assert (numerics() != before) == changes


def test_the_numerics_change_with_renamed_modules_wherever_they_are_remembered(package, tmp_path, monkeypatch):
    (tmp_path / "closed").touch()
    found = []
    for name in ("new", "newer"):
        (package / f"theory/{name}.py").touch()
        for cache in ("cache", "cache", "closed"):
            monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / cache))
            found.append(numerics())
        (package / f"theory/{name}.py").unlink()
    assert found == [found[0]] * 3 + [found[-1]] * 3
    assert len({*found}) == len([*(tmp_path / "cache/digests").iterdir()]) == 2


# Modules that solving curves imports and numerics leave out, since no number changes with them: keys, cases and
# figures of a scene, bodies (loads and modulus are in the name of a kind), words, files and progress.
LEFT_OUT = (
    "scene/models scene/trace_keys scene/file scene/cases scene/figure data/bodies data/curves data/si "
    "data/variables data/files data/provenance data/markdown api/progress"
)
RUN = {"api/progress.py", "data/files.py"}  # these run while curves are solved
SOLVED = """
import sys
from pathlib import Path
from weier.digests import CURVES, PACKAGE, files_of, numerics
from weier.pipeline.needed_curves import Curves
from weier.pipeline.jobs import solve
from weier.pipeline.store import Store
from weier.scene import load

run = set()
def noted(frame, event, argument):
    run.add(frame.f_code.co_filename)

def outside(files):
    inside = {path.relative_to(PACKAGE).as_posix() for path in map(Path, files) if PACKAGE in path.parents}
    return sorted(name for name in inside - {*files_of(CURVES)} if not name.endswith("__init__.py"))

for path in map(Path, sys.argv[1:]):
    curves = Curves(load(path), Store(path.with_suffix(""), numerics()))
    lacking = curves.store.lacking(curves.parts_for())
    sys.setprofile(noted)
    solve(lacking, curves.store, "test", lambda line: None)
    sys.setprofile(None)
print(*sorted({part.kind.method for part in lacking}))
print(*outside(getattr(module, "__file__", None) or "" for module in list(sys.modules.values())))
print(*outside(run))
"""
BY_EACH_METHOD = """
title: by each method
loads: [{loads}]
methods: [{methods}]
interface: {{mu_1: 80 GPa, mu_2: 80 GPa, nu_1: 0.3, nu_2: 0.3, rho_1: 1.0e-7, rho_2: 1.0e-7,
  lambda_0: 1 mm, g_0: 1 um}}
studies:
  series: {{product: {{D: 1.25, gamma: "5/2", m: [1, 2], seed: 1}}}}
  infinite: {{product: {{D: 1.25, gamma: 5, m: .inf}}, methods: [demelio, layer, persson]}}
  line: {{trace: {{file: line.csv, length: 1.0e-3, height_unit: um, shortest: 3.0e-4}}, methods: [bem, patches]}}
"""


def test_all_that_solving_curves_runs_is_in_their_numerics(tmp_path, monkeypatch):
    """Of a share of each method, of a trace, in p_0* and in SI units, in a fresh process."""
    scenes = {tmp_path / "normalised.yaml": "0.1, 1.0", tmp_path / "si.yaml": "1 MPa, 10 MPa"}
    for path, loads in scenes.items():
        path.write_text(BY_EACH_METHOD.format(loads=loads, methods=", ".join(registry.names())))
    (tmp_path / "line.csv").write_text("\n".join(map(str, HEIGHTS)))
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    done = subprocess.run([sys.executable, "-c", SOLVED, *scenes], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    solved, imported, run = map(str.split, done.stdout.splitlines())
    assert solved == sorted([*registry.names(), "surface"])
    assert {*imported} == {f"{name}.py" for name in LEFT_OUT.split()}
    assert {*run} <= RUN
    names = ["solved", "not_requested", "not_applicable", "not_converged"]  # the numbers in stored curves
    assert [status.name for status in sorted(Status)] == names


# --- 3. A trace is its final heights, whatever they come from. ---

BODIES = {"mu_1": 8e10, "mu_2": 8e10, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 1e-7, "rho_2": 2e-7}
LINE = {"file": "line.csv", "length": 1e-3, "height_unit": "um"}
HEIGHTS = [0, 1, 0.5, -1, 2, 0.25, -0.5, 1.5, 0, -1, 0.5, 1, -2, 0.75, -0.5, -1.5]


def trace_keys(folder, heights=HEIGHTS, **changes):
    """The names of the kinds of its curves, and the keys of its surface."""
    (folder / "line.csv").write_text("\n".join(map(str, heights)))
    scene = {"title": "t", "loads": ["1 MPa", "10 MPa"], "methods": ["bem"], "interface": BODIES}
    found = curves_in(scene_in(folder, scene | {"studies": {"one": {"trace": LINE | changes}}}), folder)
    return [part.kind.name for part in found.parts], [part.keys.tolist() for part in found.surfaces]


def test_a_trace_is_its_final_heights(tmp_path, monkeypatch):
    """Of other settings of its reader, another file, or another code of detrending."""
    kinds, keys = trace_keys(tmp_path)
    assert trace_keys(tmp_path, length=0.001) == (kinds, keys)
    for change in ({"shortest": 3e-4}, {"detrend": "mean"}, {"height_unit": "nm"}, {"heights": HEIGHTS[::-1]}):
        assert trace_keys(tmp_path, **change)[1] != keys
    usual = traces._checked_level
    monkeypatch.setattr(traces, "_checked_level", lambda *given: usual(*given) * (1 + 1e-15))
    case._read_once.cache_clear()  # as in another process
    assert trace_keys(tmp_path)[1] != keys
    monkeypatch.undo()
    case._read_once.cache_clear()
    monkeypatch.setattr(bodies.Bodies, "composite_modulus", 1e10)
    other_kinds, same_keys = trace_keys(tmp_path)
    assert (other_kinds != kinds, same_keys) == (True, keys)


# --- 5. Another value of any key of a scene makes again what depends on it. ---

PRODUCT = {"D": 1.25, "gamma": 5, "m": [1, 2]}
STUDIES = {"short": {"product": PRODUCT}, "long": {"product": {**PRODUCT, "m": [3, 4]}}}
FIGURES = {
    "one": {"draw": "compliance", "studies": ["short"]},
    "two": {"draw": "resistance", "studies": ["long"], "behind": ["short"]},
}
SCENE = {"title": "t", "loads": [0.1, 1.0], "methods": ["archard", "demelio"], "studies": STUDIES, "figures": FIGURES}
ALL = {DATA, PAGE, "one", "two"}


def digests_of(folder, **changes):
    curves = curves_in(scene_in(folder, SCENE | changes), folder / "curves")
    return {name: made_of(curves, name) for name in names_of(curves.scene)}


def studies(**changes):
    return {"studies": STUDIES | {"long": STUDIES["long"] | changes}}


def more(**study):
    return {"studies": STUDIES | {"more": study}}


SURFACE = {"lambda_0": 1e-3, "g_0": 1e-6}
RANDOM = {"hurst": 0.8, "length": "1 mm", "shortest": "0.2 mm", "rms_height": "1 um"}
# Each key of a scene and a study, with the products that another value of it changes.
KEYS = {
    "title": ({"title": "another"}, {DATA, PAGE}),
    "max_cases": ({"max_cases": 99}, {DATA}),  # which has the text of the scene
    "loads": ({"loads": [0.2, 1.0]}, ALL),
    "methods": ({"methods": ["archard"]}, ALL),
    "tolerance": ({"methods": ["auto"], "tolerance": 0.1}, ALL),
    "settings": ({"methods": ["layer"], "settings": {"layer": {"points": 40}}}, ALL),
    "contact_edges": ({"contact_edges": True}, ALL),
    "interface": ({"interface": BODIES | SURFACE}, ALL),
    "studies": (more(product=PRODUCT), {DATA, PAGE}),
    "figures": ({"figures": FIGURES | {"one": FIGURES["one"] | {"title": "other"}}}, {DATA, "one"}),
    "claims": ({"claims": {"closed_forms_agree": ["short"]}}, {DATA}),
    "study.product": (studies(product={**PRODUCT, "m": [3, 5]}), {DATA, PAGE, "two"}),
    "study.cases": ({"studies": {**STUDIES, "long": {"cases": [PRODUCT]}}}, {DATA, PAGE, "two"}),
    "study.trace": (more(trace=LINE, methods=["bem"]), {DATA, PAGE}),
    "study.random": (more(random=RANDOM, methods=["bem"]), {DATA, PAGE}),
    "study.loads": (studies(loads=[0.1]), {DATA, PAGE, "two"}),
    "study.methods": (studies(methods=["archard"]), {DATA, PAGE, "two"}),
    "study.settings": (studies(methods=["layer"], settings={"layer": {"points": 40}}), {DATA, PAGE, "two"}),
}


def test_another_value_of_a_key_makes_its_products_again(tmp_path, monkeypatch):
    """And other heights of a trace, the same pressure in another unit, or another date of the data."""
    from weier.scene.models import SceneKeys, StudyKeys

    assert {*SceneKeys.model_fields, *(f"study.{key}" for key in StudyKeys.model_fields)} == KEYS.keys()

    def changed(one, other):
        return {name for name in ALL if one[name] != other[name]}

    (tmp_path / "line.csv").write_text("\n".join(map(str, HEIGHTS)))
    before, line = digests_of(tmp_path), KEYS["study.trace"][0]
    for key, (changes, expected) in KEYS.items():
        assert (key, changed(before, digests_of(tmp_path, **changes))) == (key, expected)
    first, _ = digests_of(tmp_path, **line), (tmp_path / "line.csv").write_text("\n".join(map(str, HEIGHTS[::-1])))
    assert changed(first, digests_of(tmp_path, **line)) == {DATA, PAGE}
    units = [digests_of(tmp_path, interface=BODIES | SURFACE, loads=[load]) for load in ("1 MPa", "1e6 Pa")]
    assert changed(*units) == ALL
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "2000000000")
    assert changed(before, digests_of(tmp_path)) == {DATA}
