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
REFUSED = "the code of weier has changed since {}: run snakemake again, which plans with the new code"


def solve_all(curves):
    solve(curves.store.lacking(curves.parts_for()), curves.store, "test", lambda line: None)


@pytest.mark.parametrize("module", ["methods/demelio.py", "scene/case.py", "api/rows.py", "pipeline/store.py", ""])
def test_code_that_changes_while_a_job_works_is_no_code_of_its_curves(tmp_path, package, monkeypatch, module):
    """Also another version of a package. What was appended before stays, and an undone edit leaves nothing behind."""
    curves = curves_in(scene_in(tmp_path, SHORT), tmp_path / "curves")
    monkeypatch.setattr(jobs, "APPEND_SECONDS", 0)
    own, done = jobs._row, []

    def edited(*given):
        if len(done) == 5 and module:
            with (package / module).open("a") as file:
                file.write("\nMORE = 1\n")
        elif len(done) == 5:
            monkeypatch.setattr(digests, "versions", lambda: "numpy 0")
        done.append(given)
        return own(*given)

    with monkeypatch.context() as patch:
        patch.setattr(jobs, "_row", edited)
        with pytest.raises(ValueError, match=REFUSED.format("this job began")):
            solve_all(curves)
        with pytest.raises(ValueError, match=REFUSED.format("the plan")):
            solve_all(curves)  # nor does a job begin that was planned before
    shutil.copy(PACKAGE / (module or "checks.py"), package / (module or "checks.py"))
    monkeypatch.undo()
    again = curves_in(curves.scene, curves.store.folder)
    assert len(done) == 6
    assert sum(len(part.keys) for part in again.store.lacking(again.parts_for())) == 12 - 5


# --- 2. An edit that changes a number changes the numerics. 4. Words change nothing. ---

EDITS = {
    "Case.profile": ("scene/case.py", 'random_phases(p["seed"])', 'random_phases(p["seed"] + 1)', True),
    "the order of phases": ("surface/profile.py", "2 * np.pi, m)", "2 * np.pi, m)[::-1]", True),
    "a default": (
        "methods/bem/boundary_elements.py",
        "points_per_wave: int | None = None",
        "points_per_wave: int = 32",
        True,
    ),
    "what is stored of a row": ("pipeline/store.py", "column[row, ...]", "column[~row, ...]", True),
    "a docstring": ("api/task.py", '"""A curve to solve', '"""One curve to solve', False),
    "a comment": ("surface/profile.py", "\n\n\n", "\n\n\n# A comment.\n", False),
    "an annotation": ("pipeline/needed_curves.py", "method: str", "method: object", False),
    "a reader of files": ("surface/measured/text.py", "\n\n\n", "\n\n\nMORE = 1\n\n\n", False),
    "a figure": ("figures/many_curves.py", "\n\n\n", "\n\n\nMORE = 1\n\n\n", False),
}


@pytest.mark.parametrize("edit", EDITS)
def test_the_numerics_change_with_what_may_change_a_number_alone(package, edit):
    module, old, new, changes = EDITS[edit]
    before, text = numerics(), (package / module).read_text()
    assert old in text
    (package / module).write_text(text.replace(old, new, 1))
    assert (numerics() != before) == changes


def test_the_numerics_change_with_new_lost_and_renamed_modules_wherever_they_are_remembered(
    package, tmp_path, monkeypatch
):
    (tmp_path / "closed").touch()
    found = []
    for cache in ("cache", "cache", "closed"):
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / cache))
        (package / "theory/new.py").touch()
        found.append([numerics()])
        (package / "theory/new.py").rename(package / "theory/newer.py")
        found[-1].append(numerics())
        (package / "theory/newer.py").unlink()
        found[-1].append(numerics())
    assert found[0] == found[1] == found[2]
    assert len({*found[0]}) == len([*(tmp_path / "cache/digests").iterdir()]) == 3


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


CHANGES = (
    {"shortest": 3e-4},
    {"ends": "periodic"},
    {"detrend": "mean"},
    {"height_unit": "nm"},
    {"heights": HEIGHTS[::-1]},
)
STEPS = (lambda level: level * (1 + 1e-15), lambda level: level - level[0], lambda level: level[::-1])


@pytest.mark.parametrize("change", [*CHANGES, *STEPS])
def test_a_trace_is_its_final_heights(tmp_path, monkeypatch, change):
    """Of other settings of its reader, another file, or another code of detrending."""
    kinds, keys = trace_keys(tmp_path)
    assert trace_keys(tmp_path, length=0.001) == (kinds, keys)
    if isinstance(change, dict):
        assert trace_keys(tmp_path, **change)[1] != keys
    else:
        usual = traces._checked_level
        monkeypatch.setattr(traces, "_checked_level", lambda *given: change(usual(*given)))
        case._read_once.cache_clear()  # as in another process
        assert trace_keys(tmp_path)[1] != keys


def test_another_constant_in_the_formulas_of_bodies_is_another_kind(tmp_path, monkeypatch):
    kinds, keys = trace_keys(tmp_path)
    monkeypatch.setattr(bodies.Bodies, "composite_modulus", 1e10)
    assert trace_keys(tmp_path)[0] != kinds
    assert trace_keys(tmp_path)[1] == keys


# --- 5. Another value of any key of a scene makes again what depends on it. ---

PRODUCT = {"D": 1.25, "gamma": 5, "m": [1, 2]}
SCENE = {
    "title": "test",
    "loads": [0.1, 1.0],
    "methods": ["archard", "demelio"],
    "studies": {"short": {"product": PRODUCT}, "long": {"product": {**PRODUCT, "m": [3, 4]}}},
    "figures": {
        "one": {"draw": "compliance", "studies": ["short"]},
        "two": {"draw": "resistance", "studies": ["long"], "behind": ["short"]},
    },
}
ALL = {DATA, PAGE, "one", "two"}


def digests_of(folder, **changes):
    curves = curves_in(scene_in(folder, SCENE | changes), folder / "curves")
    return {name: made_of(curves, name) for name in names_of(curves.scene)}


def figures(**changes):
    return {"figures": SCENE["figures"] | {"one": SCENE["figures"]["one"] | changes}}


def studies(**changes):
    return {"studies": SCENE["studies"] | {"long": SCENE["studies"]["long"] | changes}}


RANDOM = {"hurst": 0.8, "length": "1 mm", "shortest": "0.2 mm", "rms_height": "1 um"}
# Each key of a scene and a study, with the products that another value of it changes.
KEYS = {
    "title": ({"title": "another"}, {DATA, PAGE}),
    "max_cases": ({"max_cases": 99}, {DATA}),  # which has the text of the scene
    "loads": ({"loads": [0.1, 2.0]}, ALL),
    "methods": ({"methods": ["archard"]}, ALL),
    "tolerance": ({"methods": ["auto"], "tolerance": 0.1}, ALL),
    "settings": ({"methods": ["layer"], "settings": {"layer": {"points": 40}}}, ALL),
    "contact_edges": ({"contact_edges": True}, ALL),
    "interface": ({"interface": BODIES | {"lambda_0": 1e-3, "g_0": 1e-6}}, ALL),
    "studies": ({"studies": SCENE["studies"] | {"more": {"product": PRODUCT}}}, {DATA, PAGE}),
    "figures": (figures(title="other"), {DATA, "one"}),
    "claims": ({"claims": {"closed_forms_agree": ["short"]}}, {DATA}),
    "study.product": (studies(product={**PRODUCT, "m": [3, 5]}), {DATA, PAGE, "two"}),
    "study.cases": ({"studies": {**SCENE["studies"], "long": {"cases": [PRODUCT]}}}, {DATA, PAGE, "two"}),
    "study.trace": (studies(), set()),  # below: its heights
    "study.random": (
        {"studies": SCENE["studies"] | {"more": {"random": RANDOM, "methods": ["bem"]}}},
        {DATA, PAGE},
    ),
    "study.loads": (studies(loads=[0.1]), {DATA, PAGE, "two"}),
    "study.methods": (studies(methods=["archard"]), {DATA, PAGE, "two"}),
    "study.settings": (studies(methods=["layer"], settings={"layer": {"points": 40}}), {DATA, PAGE, "two"}),
}


@pytest.mark.parametrize("key", KEYS)
def test_another_value_of_a_key_makes_its_products_again(tmp_path, key):
    changes, expected = KEYS[key]
    before, after = digests_of(tmp_path), digests_of(tmp_path, **changes)
    assert {name for name in ALL if before[name] != after[name]} == expected
    assert digests_of(tmp_path) == before


def test_data_of_another_date_are_other_data(tmp_path, monkeypatch):
    """Figures and the explorer have no dates."""
    found = []
    for date in ("", "1000000000", "2000000000"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
        found.append(digests_of(tmp_path))
    assert len({one[DATA] for one in found}) == 3
    assert all(len({one[name] for one in found}) == 1 for name in ALL - {DATA})


def test_the_same_pressures_in_another_unit_make_all_products_again(tmp_path):
    bodies = BODIES | {"lambda_0": 1e-3, "g_0": 1e-6}
    before, after = (digests_of(tmp_path, interface=bodies, loads=[load]) for load in ("1 MPa", "1e6 Pa"))
    assert {name for name in ALL if before[name] != after[name]} == ALL


def test_each_key_of_a_scene_is_above():
    from weier.scene.models import SceneKeys, StudyKeys

    known = {*SceneKeys.model_fields, *(f"study.{key}" for key in StudyKeys.model_fields)}
    assert known == KEYS.keys()


def test_other_heights_of_a_trace_make_again_what_reads_them(tmp_path):
    own = {"line": {"trace": LINE, "methods": ["bem"]}}
    three = {"three": {"draw": "compliance", "studies": ["line"]}}
    changes, found = {"studies": SCENE["studies"] | own, "figures": SCENE["figures"] | three}, []
    for heights in (HEIGHTS, [1.75, *HEIGHTS[1:]]):
        (tmp_path / "line.csv").write_text("\n".join(map(str, heights)))
        found.append(digests_of(tmp_path, **changes))
    assert {name for name in found[0] if found[0][name] != found[1][name]} == {DATA, PAGE, "three"}
