"""Scene files: what they expand to, and what is said about a bad one."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.toy_method import TOY
from weier import scene
from weier.methods import registry
from weier.scene.file import schema

SCENES = sorted(Path("config").glob("*/*.yaml"))

MINIMAL = {
    "title": "test",
    "loads": [0.1, 1.0],
    "methods": ["demelio"],
    "studies": {"one": {"product": {"D": 1.25, "gamma": 5, "m": 2}}},
}


def product(**changes):
    return {"studies": {"one": {"product": {"D": 1.5, "gamma": 5, "m": 2} | changes}}}


def write(folder, **changes):
    path = folder / "scene.yaml"
    path.write_text(yaml.safe_dump(MINIMAL | changes))
    return path


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_every_scene_that_comes_with_weier_is_sound(path):
    loaded = scene.load(path)
    assert loaded.name == path.stem
    solved = [case.key for cases in loaded.batches.values() for case in cases]
    assert len(solved) == len(set(solved))
    assert set(solved) == {case.key for cases in loaded.studies.values() for case in cases}


def test_the_schema_knows_every_method(monkeypatch):
    assert schema()["$defs"]["method"]["enum"] == registry.names()
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS, TOY))
    assert schema()["$defs"]["method"]["enum"][-1] == TOY.name


def test_figures_and_claims_may_have_any_name(tmp_path):
    """Which there are, the figures and the claims know."""
    changes = {"figures": {"f": {"draw": "anything", "studies": ["one"]}}, "claims": {"anything": ["one"]}}
    loaded = scene.load(write(tmp_path, **changes))
    assert loaded.figures["f"].draw == "anything"
    assert loaded.claims == {"anything": ("one",)}


def test_the_sweep_has_some_hundreds_of_cases():
    loaded = scene.load("config/scenes/sweep.yaml")
    assert 200 <= sum(map(len, loaded.batches.values())) <= 1000


def test_the_loads_of_the_paper_are_dense_where_contacts_are_born_and_merge():
    loads = scene.load("config/scenes/paper.yaml").loads
    shown = loads[(loads > 0.01) & (loads < 8)]  # on the axes of Figs 5, 6 and 8
    assert (shown[1:] / shown[:-1]).max() < 1.03  # less than half a millimetre of a column


def test_a_product_is_every_combination(tmp_path):
    study = {"product": {"D": [1.25, 1.5], "gamma": [2, "5/2"], "m": 3, "seed": {"from": 0, "to": 2, "count": 3}}}
    cases = scene.load(write(tmp_path, studies={"one": study})).studies["one"]
    assert len(cases) == 12
    assert {str(case.profile.gamma) for case in cases} == {"2", "5/2"}
    assert len({tuple(case.profile.phase) for case in cases}) == 3


def test_a_list_may_hold_ranges(tmp_path):
    loads = [{"from": 0.1, "to": 0.3, "count": 3}, 0.5, {"from": 1, "to": 100, "count": 3, "spacing": "log"}]
    study = {"product": {"D": 1.25, "gamma": 5, "m": [1, {"from": 3, "to": 5, "count": 3}]}}
    loaded = scene.load(write(tmp_path, loads=loads, studies={"one": study}))
    assert loaded.loads == pytest.approx([0.1, 0.2, 0.3, 0.5, 1, 10, 100])
    assert [case.profile.m for case in loaded.studies["one"]] == [1, 3, 4, 5]
    with pytest.raises(scene.SceneError, match="at most 3 cases, got 4"):
        scene.load(write(tmp_path, studies={"one": study}, max_cases=3))


def test_a_list_of_cases_is_itself(tmp_path):
    rows = [
        {"D": 1.25, "gamma": 5, "m": 2, "phases": [[0, 1]]},
        {"D": 1.5, "gamma": 3, "m": 1},
        {"D": 1.5, "gamma": 3, "m": float("inf")},
    ]
    cases = scene.load(write(tmp_path, studies={"one": {"cases": rows}})).studies["one"]
    assert [case.profile.m for case in cases] == [2, 1, np.inf]
    assert cases[0].profile.phase == pytest.approx([0, 1])


def test_loads_in_equal_ratios(tmp_path):
    loads = scene.load(write(tmp_path, loads={"from": 0.01, "to": 1, "count": 3, "spacing": "log"})).loads
    assert loads == pytest.approx([0.01, 0.1, 1])


def test_a_case_of_two_studies_is_solved_once_and_a_study_needs_only_its_batches(tmp_path):
    shared = {"D": 1.25, "gamma": 5, "m": 2}
    studies = {
        "one": {"product": shared},
        "two": {"product": shared | {"m": [1, 2]}},
        "three": {"product": shared | {"m": 3}},
    }
    loaded = scene.load(write(tmp_path, studies=studies))
    assert sum(map(len, loaded.batches.values())) == 3
    assert sorted(case.profile.m for case in loaded.cases.values()) == [1, 2, 3]
    assert set(loaded.cases) == {case.key for cases in loaded.studies.values() for case in cases}
    assert len(loaded.batches_of("one")) == 1
    assert len(loaded.batches_of("two")) == 2
    assert loaded.batches_of("three") == ["three-0"]
    assert loaded.batches_of("two", "one", "two") == loaded.batches_of("two")


def test_the_digest_of_cases_follows_which_there_are_and_their_order(tmp_path):
    def digest(*terms):
        study = {"product": {"D": 1.25, "gamma": 5, "m": list(terms)}}
        return scene.load(write(tmp_path, studies={"one": study})).digest_of_cases("one")

    assert digest(1, 2) == digest(1, 2)
    assert len({digest(1, 2), digest(2, 1), digest(1, 3)}) == 3


def test_batches_are_no_larger_than_asked(tmp_path):
    study = {"product": {"D": 1.25, "gamma": 5, "m": 2, "seed": list(range(7))}}
    loaded = scene.load(write(tmp_path, studies={"one": study}, batch=3))
    assert [len(cases) for cases in loaded.batches.values()] == [3, 3, 1]


def test_the_digest_of_a_batch_follows_what_its_numbers_depend_on(tmp_path):
    def digest(**changes):
        return scene.load(write(tmp_path, **changes)).digest("one-0")

    assert digest() == digest(title="another", figures={"f": {"draw": "compliance", "studies": ["one"]}})
    assert digest() != digest(loads=[0.1, 2.0])
    assert digest() != digest(methods=["archard"])
    assert digest() != digest(contact_edges=True)
    longer = {"product": {"D": 1.5, "gamma": 5, "m": 9}, "methods": ["archard", "layer"]}
    assert digest() == digest(studies={"two": longer} | MINIMAL["studies"])


def test_a_key_of_an_older_scene_is_told_by_its_new_name(tmp_path):
    with pytest.raises(scene.SceneError, match="most_cases: this key is called max_cases now"):
        scene.load(write(tmp_path, most_cases=3))


@pytest.mark.parametrize(
    ("phases", "expected"),
    [
        (1.0, [1.0]),
        ([0.5, 1.0], [0.5, 1.0]),
        ({"from": 0, "to": 1, "count": 3}, [0.0, 0.5, 1.0]),
        ([[0.0, 2.0]], [(0.0, 2.0)]),
        ([0.5, [0.0, 2.0]], [0.5, (0.0, 2.0)]),
    ],
)
def test_phases_are_those_of_a_profile_or_a_list_of_them(phases, expected, tmp_path):
    """A number is the phase of every term but the first, a list is of all terms: as in weier.Profile."""
    loaded = scene.load(write(tmp_path, **product(m=2, phases=phases)))
    assert [case.profile.phases for case in loaded.cases.values()] == expected


def test_phases_are_given_in_one_way(tmp_path):
    values = {"phases": [[0.0, 1.0]], "seed": 3}
    for key in values:  # each alone is sound
        scene.load(write(tmp_path, **product(**{key: values[key]})))
    with pytest.raises(scene.SceneError, match="a profile takes phases or a seed, not both"):
        scene.load(write(tmp_path, **product(**values)))


def test_a_name_that_is_not_in_the_scene_is_told_with_those_that_are(tmp_path):
    loaded = scene.load(write(tmp_path))
    with pytest.raises(scene.SceneError, match="scene scene has no study 'two', only one"):
        loaded.study("two")
    with pytest.raises(scene.SceneError, match="scene scene has no figure 'two', only none"):
        loaded.figure("two")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lods": [1]}, "'lods' was unexpected"),
        ({"loads": [1.0, 0.5]}, "loads: mean_pressure must increase"),
        ({"loads": [float("nan")]}, "loads: mean_pressure must be finite"),
        ({"loads": []}, "loads"),
        ({"loads": "heavy"}, "loads"),
        ({"methods": ["bme"]}, "methods.0: 'bme' is not one of .*'bem'"),
        ({"settings": {"bme": {"points": 3}}}, "settings: 'bme' is not one of .*'bem'"),
        ({"settings": {"demelio": {"points": 3}}}, "studies.one: .*no setting 'points'"),
        (
            {"methods": ["bem"], "settings": {"bem": {"points_per_wave": 8}}},
            "studies.one: points_per_wave must be a whole number of at least 16",
        ),
        (
            {"methods": ["bem"], "settings": {"bem": {"points_per_wave": 16, "points": 800}}},
            "studies.one: points_per_wave must be left out where there are points",
        ),
        ({"methods": ["bem"], "settings": {"bem": {"points": 79}}}, "studies.one: points must be at least 80"),
        (product(D=2.5), r"studies.one: D must lie in \(1, 2\), got 2.5"),
        (product(m=0), "studies.one: m must be"),
        (product(gamma="5/0"), "studies.one: gamma must be a finite number"),
        (product(gama=5), "studies.one.*gama"),
        ({"studies": {}}, "studies"),
        (
            {"figures": {"f": {"draw": "compliance", "studies": ["two"]}}},
            "figures.f: there is no study 'two', only one",
        ),
        ({"claims": {"fourth_term": ["two"]}}, "claims.fourth_term: there is no study 'two'"),
        ({"claims": {"../c": ["one"]}}, r"claims: '\.\./c' does not match"),
        ({"figures": {"f": {"draw": "../f", "studies": ["one"]}}}, r"figures.f.draw: '\.\./f' does not match"),
        ({"batch": 0}, "batch"),
    ],
)
def test_a_bad_scene_names_the_file_and_the_key(tmp_path, changes, message):
    path = write(tmp_path, **changes)
    with pytest.raises(scene.SceneError, match=message) as caught:
        scene.load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["a: [", "- 1", "!!python/object/apply:os.getcwd []", "\x00", ""])
def test_what_is_no_scene_at_all_is_refused(tmp_path, text):
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    with pytest.raises(scene.SceneError, match=r"scene\.yaml"):
        scene.load(path)


def test_a_missing_scene_is_refused(tmp_path):
    with pytest.raises(scene.SceneError, match="cannot be read"):
        scene.load(tmp_path / "none.yaml")


@pytest.mark.parametrize("text", ["1e-2", "1.0e-2", "0.01"])
def test_a_tolerance_may_be_written_as_people_do(tmp_path, text):
    """YAML takes 1e-2 for a word."""
    path = tmp_path / "planned.yaml"
    study = "{one: {product: {D: 1.5, gamma: 2, m: 1}}}"
    path.write_text(f"title: test\nloads: [0.1]\ntolerance: {text}\nstudies: {study}\n")
    (case,) = scene.load(path).studies["one"]
    assert case.settings["planned"] == {"tolerance": 0.01}


def test_the_readme_of_the_configuration_explains_every_key():
    text = Path("config/README.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`([a-z0-9_ ]+)`", text))
    known = schema()
    keys = {*known["properties"], *known["$defs"]["study"]["properties"], *known["$defs"]["figure"]["properties"]}
    keys |= yaml.safe_load(Path("config/config.schema.json").read_text())["properties"].keys()
    assert keys - named == set()
    assert {path.stem for path in Path("config/scenes").glob("*.yaml")} <= named


def test_a_list_of_phases_counts_as_one_profile(tmp_path):
    scene.load(write(tmp_path, **product(m=2, phases=[[0.0, 2.0]]), max_cases=1))
    with pytest.raises(scene.SceneError, match="at most 1 cases, got 2"):
        scene.load(write(tmp_path, **product(m=2, phases=[[0.0, 2.0], 1.0]), max_cases=1))
