"""Scene files: what they expand to, and what is said about a bad one."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from docs import scene_keys
from weier import load_scene, scene
from weier.scene.identity import short_keys
from weier.scene.models import SceneKeys

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
    solved, listed = short_keys(loaded.keys_of_cases), loaded.products
    assert len(solved) == len(set(solved)) == len(loaded.distinct)
    assert set(solved) == {key for product in listed for key in short_keys(product.case_keys)}
    some = range(0, len(solved), max(1, len(solved) // 1000))
    own = [(loaded.distinct[number], listed[loaded.product_of_cases[number]].loads) for number in some]
    assert [case.key(loads) for case, loads in own] == [solved[number] for number in some]


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
    again = scene.load(write(tmp_path, loads=[*reversed(loads), 0.5], studies={"one": study}))
    assert again.loads.tolist() == loaded.loads.tolist(), "in whatever order, and each once"
    assert [case.profile.m for case in loaded.studies["one"]] == [1, 3, 4, 5]
    with pytest.raises(scene.SceneError, match="at most 3 cases, got 4"):
        scene.load(write(tmp_path, studies={"one": study}, max_cases=3))


def test_a_list_of_cases_is_itself(tmp_path):
    rows = [
        {"D": 1.25, "gamma": 5, "m": 2, "phases": [[0, 1]]},
        {"D": 1.5, "gamma": 3, "m": 1},
        {"D": 1.5, "gamma": 3, "m": float("inf")},
    ]
    cases = [*scene.load(write(tmp_path, studies={"one": {"cases": rows}})).studies["one"]]
    assert [case.profile.m for case in cases] == [2, 1, np.inf]
    assert cases[0].profile.phase == pytest.approx([0, 1])


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
    assert [case.profile.phases for case in loaded.distinct] == expected


ONE_MISTAKE = yaml.safe_load(Path("tests/data/scene_mistakes.yaml").read_text(encoding="utf-8"))
ONE_MISTAKE.append([{"product": {"m": 10**400}}, "studies.one.product.m: m must be a number"])


@pytest.mark.parametrize(("changes", "message"), ONE_MISTAKE, ids=lambda value: str(value)[:40])
def test_one_mistake_is_one_line_with_the_file_and_the_key(tmp_path, changes, message):
    if "product" in changes:
        changes = product(**changes["product"]) | {key: changes[key] for key in changes if key != "product"}
    path = write(tmp_path, **changes)
    with pytest.raises(scene.SceneError, match=rf"^{re.escape(str(path))}, line \d+: {message}") as caught:
        load_scene(path)
    assert "\n" not in str(caught.value)


FAULTY = """title: test
loads: {from: 1.0e-3, to: 4, n: 30}
methods: [layer]
studies:
  one: {product: &p {D: 2.5, gamma: 5, m: 0}}
  two: {product: {<<: *p, gamma: 1}}
figures:
  f: {draw: compliance, colour: gama}
"""


def test_all_mistakes_are_reported_together_with_their_lines(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(FAULTY)
    with pytest.raises(scene.SceneError) as caught:
        load_scene(path)
    places = re.findall(r"^  line (\d+): ([^:]+): ", str(caught.value), re.M)
    products = [("5", "one.product.D"), ("5", "one.product.m"), ("5", "two.product.D"), ("5", "two.product.m")]
    studies = [(line, f"studies.{key}") for line, key in [*products, ("6", "two.product.gamma")]]
    assert sorted(places) == sorted([("2", "loads.0.count"), ("2", "loads.0.n"), *studies, ("8", "figures.f.colour")])


def test_the_table_of_keys_is_that_of_the_models(tmp_path):
    written = Path(shutil.copy("config/README.md", tmp_path))
    scene_keys.write(written)
    text = written.read_text(encoding="utf-8")
    assert text == Path("config/README.md").read_text(encoding="utf-8"), "run python docs/scene_keys.py"
    assert {*SceneKeys.model_fields} <= set(re.findall(r"\| `(\w+)` \|", text))
