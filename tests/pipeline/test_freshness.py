"""What must not pass as fresh, and what must not be solved again: five faults, each with its relatives."""

import shutil

import pytest

from tests.scenes import curves_in, scene_in
from weier import digests
from weier.data import bodies
from weier.digests import PACKAGE, numerics
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

SHORT = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["archard", "demelio"],
    "studies": {"one": {"product": {"D": [1.25, 1.5], "gamma": 2, "m": [1, 2]}}},
}


@pytest.mark.parametrize("module", ["methods/demelio.py", "scene/case.py", ""])
def test_code_that_changes_while_a_job_works_is_no_code_of_its_curves(tmp_path, package, monkeypatch, module):
    """Also another version of a package. What was appended before stays, and an undone edit leaves nothing behind."""
    curves = curves_in(scene_in(tmp_path, SHORT), tmp_path / "curves")
    monkeypatch.setattr(jobs, "APPEND_SECONDS", 0)
    own, done = jobs._row, []

    def edited(*given):
        done.append(given)
        if len(done) == 6 and module:
            (package / module).write_text((package / module).read_text() + "\nMORE = 1\n")
        elif len(done) == 6:
            monkeypatch.setattr(digests, "versions", lambda: "numpy 0")
        return own(*given)

    with monkeypatch.context() as patch:
        patch.setattr(jobs, "_row", edited)
        for since in ("this job began", "the plan"):  # nor does a job begin that was planned before
            with pytest.raises(
                ValueError, match=f"^the code of weier has changed since {since}: run snakemake again"
            ):
                solve(curves.store.lacking(curves.parts_for()), curves.store, "test", lambda line: None)
    monkeypatch.undo()
    again = curves_in(curves.scene, curves.store.folder)
    assert (len(done), sum(len(part.keys) for part in again.store.lacking(again.parts_for()))) == (6, 12 - 5)


# --- 2. An edit that changes a number changes the numerics. 4. Words change nothing. ---

EDITS = [
    ("scene/case.py", 'random_phases(p["seed"])', 'random_phases(p["seed"] + 1)', True),
    ("surface/profile.py", "2 * np.pi, m)", "2 * np.pi, m)[::-1]", True),
    ("methods/bem/boundary_elements.py", "points_per_wave: int | None = None", "points_per_wave: int = 32", True),
    ("pipeline/store.py", "column[row, ...]", "column[~row, ...]", True),
    ("surface/measured/trace.py", "\n\n\n", "\n\n\nMORE = 1\n\n\n", True),
    ("api/task.py", '"""A curve to solve', '"""One curve to solve', False),
    ("surface/profile.py", "\n\n\n", "\n\n\n# A comment.\n", False),
    ("pipeline/needed_curves.py", "method: str", "method: object", False),
    ("surface/measured/text.py", "\n\n\n", "\n\n\nMORE = 1\n\n\n", False),  # a reader of files
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
    for cache in ("cache", "cache", "closed"):
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / cache))
        found.append([])
        for name in ("new", "newer"):
            (package / f"theory/{name}.py").touch()
            found[-1].append(numerics())
            (package / f"theory/{name}.py").unlink()
    assert found[0] == found[1] == found[2]
    assert len({*found[0]}) == len([*(tmp_path / "cache/digests").iterdir()]) == 2


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
