"""Scene files: what they expand to, and what is said about a bad one."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.toy_method import TOY
from weier import load_scene, scene
from weier.methods import registry
from weier.scene.schema import schema

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
    loaded = load_scene(path)  # with its figures and claims
    assert loaded.name == path.stem
    solved = [case.key for case in loaded.distinct]
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
    assert 200 <= len(loaded.distinct) <= 1000


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


def test_a_case_of_two_studies_is_solved_once(tmp_path):
    shared = {"D": 1.25, "gamma": 5, "m": 2}
    loaded = scene.load(
        write(tmp_path, studies={"one": {"product": shared}, "two": {"product": shared | {"m": [1, 2]}}})
    )
    assert [case.profile.m for case in loaded.distinct] == [2, 1]
    assert loaded.studies_of_cases == [("one", "two"), ("two",)]


def test_the_digest_of_cases_follows_which_there_are_and_their_order(tmp_path):
    def digest(*terms):
        study = {"product": {"D": 1.25, "gamma": 5, "m": list(terms)}}
        return scene.load(write(tmp_path, studies={"one": study})).digest_of_cases("one")

    assert digest(1, 2) == digest(1, 2)
    assert len({digest(1, 2), digest(2, 1), digest(1, 3)}) == 3


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


def test_a_name_that_is_not_in_the_scene_is_told_with_those_that_are(tmp_path):
    loaded = scene.load(write(tmp_path))
    with pytest.raises(scene.SceneError, match="scene scene has no study 'two', only one"):
        loaded.study("two")
    with pytest.raises(scene.SceneError, match="scene scene has no figure 'two', only none"):
        loaded.figure("two")


BODIES = {
    "mu_1": "45e9", "mu_2": 75e9, "nu_1": 0.34, "nu_2": 0.3, "rho_1": 2e-8, "rho_2": 0, "lambda_0": 1e-3, "g_0": 1e-6,
}  # fmt: skip
ONE_MISTAKE = [
    ({"lods": [1]}, "lods: there is no such key, only title.*: did you mean 'loads'?"),
    ({"loads": [1.0, 0.5]}, "loads: mean_pressure must increase"),
    ({"loads": [float("nan")]}, "loads: mean_pressure must be finite"),
    ({"loads": []}, "loads: this must have at least 1 entry"),
    ({"loads": "heavy"}, "loads: a load must be a number, got 'heavy'"),
    ({"loads": True}, "loads: this must be a number, a range, or a list of these, got True"),
    ({"loads": {"from": 1, "to": 2, "count": 3, "m": 30}}, "loads.m: there is no such key, only from, to, count"),
    ({"loads": {"from": 1, "to": 2, "n": 30}}, "loads.n: there is no such key, only from, .*: did you mean 'count'?"),
    ({"loads": {"from": 1, "to": 2, "count": 1}}, "loads.count: this must be at least 2, got 1"),
    ({"methods": ["bme"]}, "methods.0: this must be one of .*, got 'bme': did you mean 'bem'?"),
    ({"methods": ["bem", "bem"]}, "methods: each of these may stand once"),
    ({"methods": "bem"}, "methods: this must be a list, got 'bem'"),
    ({"methods": None}, "methods: this must be a list, got None"),
    ({"settings": {"bme": {"points": 3}}}, "settings.bme: this must be one of .*: did you mean 'bem'?"),
    ({"settings": {"demelio": {"points": 3}}}, "settings.demelio.points: .*no setting 'points'"),
    (
        {"settings": {"bem": {"residual_tolerence": 3}}},
        "settings.bem.residual_tolerence: .* mean 'residual_tolerance'?",
    ),
    (
        {"methods": ["bem"], "settings": {"bem": {"points_per_wave": 8}}},
        "studies.one.product: points_per_wave must be a whole number of at least 16",
    ),
    ({"methods": ["bem"], "settings": {"bem": {"points": 79}}}, "studies.one.product: points must be at least 80"),
    ({"settings": {"bem": {"solver": "fast"}}}, 'settings.bem.solver: solver must be "fft" or "direct"'),
    ({"settings": {"bem": {"edges": "node"}}}, "settings.bem.edges: edges must be .*, got 'node'"),
    ({"settings": {"planned": {"quantity": "h"}}}, "settings.planned.quantity: quantity must be one of compliance"),
    (
        product(m="inf") | {"methods": ["bem", "westergaard"]},
        'studies.one: no method applies to any of these profiles: "bem": m = inf has no finest wave',
    ),
    ({"interface": BODIES | {"mu_1": 0}}, "interface: mu_1 must be positive"),
    ({"interface": BODIES | {"mu": 1}}, "interface.mu: there is no such key"),
    ({"figures": {"f": {"draw": "compliance", "units": "SI"}}}, "figures.f.units: this must be one of si"),
    ({"figures": {"f": {"draw": "compliance", "units": "si"}}}, "figures.f.units: SI units need the key interface"),
    ({"tolerance": -1}, "tolerance: this must be more than 0, got -1"),
    ({"tolerance": 1e-20}, r"tolerance: tolerance of planned must lie in \[1e-15, 1\), got 1e-20"),
    ({"figures": {"f": "compliance"}}, "figures.f: this must be a mapping, got 'compliance'"),
    ({"tolerance": "small"}, "tolerance: tolerance must be a number, got 'small'"),
    ({"quantity": "compliance"}, "quantity needs tolerance"),
    (product(D=2.5), r"studies.one.product.D: D must lie in \(1, 2\), got 2.5"),
    (product(m=0), "studies.one.product.m: m must be"),
    (product(gamma="5/0"), "studies.one.product.gamma: gamma must be a finite number"),
    (product(gama=5), "studies.one.product.gama: there is no such key"),
    (product(phases=[[0, 1, 2]]), "studies.one.product: "),
    (product(seed=-1), "studies.one.product.seed: seed must be"),
    (product(seed={"from": 0, "to": 1, "count": 10**7}), "max_cases: .*at most 10000 cases, got 10000000: say max_c"),
    (product(phases=1.0, seed=3), "studies.one.product: a profile takes phases or a seed, not both"),
    ({"loads": {"from": 1, "to": 2, "count": 20000}}, "loads: .*at most 10000 loads"),
    ({"loads": [1e-300, 1]}, "loads: .*loads must lie in"),
    (product(m=10**400), "studies.one.product.m: m must be a number"),
    (product(phases=1e15), "studies.one.product: phases must lie in"),
    (product(m=12) | {"methods": ["bem"]}, "studies.one.product: .*at most 100000 times into the period"),
    ({"settings": {"bem": {"points": 10**9}}}, "settings.bem.points: points of bem must be .* 1 to 10000000, got"),
    ({"studies": {}}, "studies: this must have at least 1 entry"),
    ({"studies": {"one": True}}, "studies.one: this must be a mapping, got True"),
    ({"studies": {"one": {}}}, "studies.one: one of product, cases, trace must be given, and not none"),
    (
        {"figures": {"f": {"draw": "compliance", "studies": ["on"]}}},
        "figures.f.studies.0: there is no study 'on', only one: did you mean 'one'?",
    ),
    ({"figures": {"f": {"draw": "phases", "x": "lin"}}}, "figures.f.x: this must be one of .*did you mean 'linear'?"),
    ({"figures": {"f": {"draw": "phases", "x": {"from": 2, "to": 1}}}}, "figures.f.x: an axis must begin below"),
    (
        {"figures": {"f": {"draw": "phases", "y": {"scale": "log", "from": 0}}}},
        "figures.f.y: a logarithmic axis",
    ),
    ({"figures": {"f": {"draw": "phases", "size": [3]}}}, "figures.f.size: this must have at least 2 entries"),
    ({"claims": {"fourth_term": ["two"]}}, "claims.fourth_term.0: there is no study 'two'"),
    ({"claims": {"../c": ["one"]}}, r"claims.\.\./c: this must be letters, digits, _ and -"),
    ({"figures": {"f": {"draw": "../f", "studies": ["one"]}}}, "figures.f.draw: this must be letters"),
    ({"title": "two\nlines"}, "title: this must be one line of at most 200 characters"),
    ({"batch": 0}, "batch: this must be at least 1, got 0"),
    ({"contact_edges": "yes"}, "contact_edges: this must be true or false, got 'yes'"),
]


@pytest.mark.parametrize(("changes", "message"), ONE_MISTAKE, ids=lambda value: str(value)[:40])
def test_one_mistake_is_one_line_with_the_file_and_the_key(tmp_path, changes, message):
    path = write(tmp_path, **changes)
    with pytest.raises(scene.SceneError, match=rf"^{re.escape(str(path))}, line \d+: {message}") as caught:
        scene.load(path)
    assert "\n" not in str(caught.value)


FAULTY = """title: test
method: [layer]
loads: {from: 1.0e-3, to: 4, n: 30}
studies:
  one:
    product: &p {D: 2.5, gama: 5, m: 0}
    settings: {bem: {points: many}}
  two:
    product: {<<: *p, gamma: 1}
    methods: [bme]
figures:
  f:
    draw: compliance
    studies:
      - two
      - tow
    colour: gama
"""


def test_all_mistakes_are_told_at_once_each_with_its_line(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(FAULTY)
    with pytest.raises(scene.SceneError) as caught:
        scene.load(path)
    head, *told = str(caught.value).splitlines()
    places = [re.match(r"  line (\d+): ([^:]+): ", line).groups() for line in told]
    assert head == f"{path} has {len(told)} mistakes:"
    assert places == [
        ("2", "method"), ("3", "loads.n"),
        *(("6", f"studies.{study}.product.{key}") for study in ("one", "two") for key in ("D", "gama", "m")),
        ("7", "studies.one.settings.bem.points"), ("9", "studies.two.product.gamma"), ("10", "studies.two.methods.0"),
        ("16", "figures.f.studies.1"), ("17", "figures.f.colour"),
    ]  # fmt: skip


def test_a_long_list_of_mistakes_is_cut_short(tmp_path):
    with pytest.raises(scene.SceneError, match=r"has 40 mistakes:(\n  line.*){30}\n  and 10 more$"):
        scene.load(write(tmp_path, **{f"key_{number}": 1 for number in range(40)}))


@pytest.mark.parametrize("text", ["a: [", "- 1", "!!python/object/apply:os.getcwd []", "\x00", ""])
def test_what_is_no_scene_at_all_is_refused(tmp_path, text):
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    with pytest.raises(scene.SceneError, match=r"scene\.yaml"):
        scene.load(path)


def test_a_missing_scene_is_refused(tmp_path):
    with pytest.raises(scene.SceneError, match=r"there is no file .*none\.yaml"):
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
