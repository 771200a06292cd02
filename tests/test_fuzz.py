"""Whatever is thrown at it: a scene is loaded or refused in a sentence, and nothing strays."""

import itertools
import math
import re

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from tests.marks import examples
from weier import scene
from weier.figures import scene_checks
from weier.methods.registry import names

FEW, MANY = 120, 5000

TEXTS = ["inf", ".nan", "nan", "5/0", "5/2", "1e-3", "1e400", "../../x", "/etc/passwd", "a\nb", ""]
CHARACTERS = ["\x00", "\ud800", "\u0661"]  # none, half of one, and a digit that is no ASCII
NUMBERS = [-1, 0, 1, 2, 5, 1.25, 1 + 1e-16, 1.0000001, 2.0, 3.0, 1e6, 10**6]
EXTREME = [1e308, -1e308, 5e-324, 10**30, 10**400, math.inf, math.nan]
RANGES = [
    {"from": 1, "to": 2, "count": 10**12},
    {"from": 0, "to": 1, "count": 3, "spacing": "log"},
    {"from": 1, "to": 3, "count": 3.0},
]
ODD = [*TEXTS, *CHARACTERS, *NUMBERS, *EXTREME, *RANGES, True, None, {}, [], [[]]]
atoms = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.dates() | st.sampled_from(ODD)
)
keys = st.text(max_size=5) | st.sampled_from(
    ["from", "to", "count", "spacing", "product", "cases", "D", 1, None, True]
)
values = st.recursive(
    atoms, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4), max_leaves=6
)
PRODUCT_KEYS = ["D", "gamma", "m", "phases", "seed", "other"]
SOLVING_KEYS = ["loads", "methods", "settings", "tolerance", "contact_edges"]
SCENE_KEYS = ["title", "studies", "figures", "claims", "batch", "max_cases", *SOLVING_KEYS]
METHODS = [name for name in names() if name != "westergaard"]  # for one wave only


@st.composite
def scenes(draw):
    """A sound scene with some values replaced by others."""
    product = {"D": 1.25, "gamma": 5, "m": 2}
    for key in draw(st.lists(st.sampled_from(PRODUCT_KEYS), max_size=3)):
        product[key] = draw(values)
    method = draw(st.sampled_from(METHODS))
    found = {"title": "fuzz", "loads": [0.1, 1.0], "methods": [method], "studies": {"one": {"product": product}}}
    if draw(st.booleans()):
        found["settings"] = {method: {draw(st.sampled_from(["points", "tolerance", "quantity"])): draw(values)}}
    for key in draw(st.lists(st.sampled_from(SCENE_KEYS), max_size=2)):
        found[key] = draw(values)
    return found


def load_or_refuse(path):
    """Load a scene that gives all files of the Snakefile, or refuse it with a sentence a mistake."""
    refusal = ""
    try:
        loaded = scene_checks.load_scene(path)
    except scene.SceneError as error:
        refusal = str(error)
    else:
        names = [name for group in (loaded.studies, loaded.figures) for name in group]
        assert all(re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_+-]*", name) for name in names)
        assert all(case.key for case in itertools.islice(loaded.distinct, 100))
        loaded.title.encode()
    lines = refusal.splitlines()
    assert len(lines) < 33
    assert all(len(line) < 2000 and (number == 0 or line.startswith("  ")) for number, line in enumerate(lines))


def check_scene(folder, found):
    check_text(folder, yaml.safe_dump(found, allow_unicode=False).encode())


def check_text(folder, text):
    path = folder / "a scene.yaml"
    path.write_bytes(text)
    load_or_refuse(path)


TEXT = st.binary(max_size=60) | st.text(alphabet="&*a!:{}[]-,|>%@`'\"\n 1.eE_~?<", max_size=60).map(str.encode)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    place = tmp_path / "ein Örtchen"
    place.mkdir()
    monkeypatch.chdir(place)
    return place


FUZZED = {"scenes": (scenes(), check_scene), "texts": (TEXT, check_text)}


@pytest.mark.filterwarnings("ignore::UserWarning")  # a doubt about a unit is as clear an answer as a refusal
@examples(FEW, MANY)
@pytest.mark.parametrize("kind", FUZZED)
def test_whatever_is_given_is_taken_or_refused_in_a_sentence(kind, folder, how_many):
    strategy, check = FUZZED[kind]
    how_many(given(strategy)(lambda found: check(folder, found)))()


LAUGHS = "a: &a [x]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{LAUGHS}loads: *i", "loads.0: a load must be a number, got"),
        (f"{LAUGHS}settings: {{layer: {{points: *i}}}}", "a: Extra inputs are not permitted"),
        ("&a [*a]", "Input should be a valid dictionary"),
        ("studies: &a {one: *a}", "studies.one.one: Extra inputs are not permitted"),
        ("a: b\n1: 2", "Keys should be strings, got 1"),
        ("figures: {true: null}", "Input should be a valid string, got True"),
        ("? [a]\n: 2", "Keys should be strings"),
        ("[" * 5000, "maximum depth"),
        ("a: " + "1" * 5000, "cannot be read"),
        ("title: a\ntitle: b", 'found duplicate key "title"'),
        ("!!python/object/apply:os.system ['touch stray']", "could not determine a constructor"),
    ],
)
def test_yaml_that_means_harm_is_refused(folder, text, message):
    path = folder / "bad.yaml"
    path.write_text(text)
    with pytest.raises(scene.SceneError, match=message):
        scene.load(path)
    assert [path.name for path in folder.iterdir()] == ["bad.yaml"]


@pytest.mark.parametrize("name", ["../x", "/etc/passwd", "a/b", "..", "a\n", "", "ü", "-x", "a" * 65, "minimal.yaml"])
def test_a_scene_name_leads_nowhere_else(name):
    with pytest.raises(ValueError, match="must be one of"):
        scene.load_by_name(name)
