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
NUMBERS = [-1, 0, 1, 2, 5, 1.25, 1 + 1e-16, 1.0000001, 1e308, -1e308, 5e-324, 10**6, 10**400, math.inf, math.nan]
RANGES = [{"from": 1, "to": 2, "count": 10**12}, {"from": 0, "to": 1, "count": 3, "spacing": "log"}]
ODD = [*TEXTS, *CHARACTERS, *NUMBERS, *RANGES, True, None, {}, [], [[]]]
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
    """The text of a sound scene with some values replaced by others."""
    product = {"D": 1.25, "gamma": 5, "m": 2}
    for key in draw(st.lists(st.sampled_from(PRODUCT_KEYS), max_size=3)):
        product[key] = draw(values)
    method = draw(st.sampled_from(METHODS))
    found = {"title": "fuzz", "loads": [0.1, 1.0], "methods": [method], "studies": {"one": {"product": product}}}
    if draw(st.booleans()):
        found["settings"] = {method: {draw(st.sampled_from(["points", "tolerance", "quantity"])): draw(values)}}
    for key in draw(st.lists(st.sampled_from(SCENE_KEYS), max_size=2)):
        found[key] = draw(values)
    return yaml.safe_dump(found, allow_unicode=False).encode()


def load_or_refuse(path, text):
    """Load a scene that gives all files of the Snakefile, or refuse it with a sentence a mistake."""
    path.write_bytes(text)
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


TEXT = st.binary(max_size=60) | st.text(alphabet="&*a!:{}[]-,|>%@`'\"\n 1.eE_~?<", max_size=60).map(str.encode)


@pytest.mark.filterwarnings("ignore::UserWarning")  # a doubt about a unit is as clear an answer as a refusal
@examples(FEW, MANY)
@pytest.mark.parametrize("texts", [scenes(), TEXT], ids=["scenes", "texts"])
def test_whatever_is_given_is_taken_or_refused_in_a_sentence(texts, tmp_path, how_many):
    how_many(given(texts)(lambda text: load_or_refuse(tmp_path / "ein Örtchen.yaml", text)))()


LAUGHS = "a: &a [x]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{LAUGHS}settings: {{layer: {{points: *i}}}}", "a: Extra inputs are not permitted"),
        ("&a [*a]", "Input should be a valid dictionary"),
        ("studies: &a {one: *a}", "studies.one.one: Extra inputs are not permitted"),
        ("? [a]\n: 2", "Keys should be strings"),
        ("[" * 5000, "maximum depth"),
        ("a: " + "1" * 5000, "cannot be read"),
        ("title: a\ntitle: b", 'found duplicate key "title"'),
        ("!!python/object/apply:os.system ['touch stray']", "could not determine a constructor"),
    ],
)
def test_yaml_that_means_harm_is_refused(tmp_path, monkeypatch, text, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(scene.SceneError, match=message):
        scene.load(tmp_path / "bad.yaml")
    assert [path.name for path in tmp_path.iterdir()] == ["bad.yaml"]
