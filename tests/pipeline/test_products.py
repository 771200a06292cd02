"""Products are made of curves, entries of the scene and code: what changes the digest of which, and what does not."""

import pytest

from tests.scenes import curves_in, scene_in
from weier import digests
from weier.pipeline import products
from weier.pipeline.products import DATA, PAGE, files_of, fill_stamp, made_of, names_of, stamp_of

PRODUCT = {"D": 1.25, "gamma": 5, "m": [1, 2]}
BODIES = {"mu_1": 8e10, "mu_2": 8e10, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 1e-7, "rho_2": 1e-7}
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


# Each key of a scene, a study and a figure, with the products that another value of it changes.
KEYS = {
    "title": ({"title": "another"}, {DATA, PAGE}),
    "max_cases": ({"max_cases": 99}, {DATA}),  # which has the text of the scene
    "loads": ({"loads": [0.1, 2.0]}, ALL),
    "methods": ({"methods": ["archard"]}, ALL),
    "tolerance": ({"methods": ["auto"], "tolerance": 0.1}, ALL),
    "max_seconds": ({"max_seconds": 99.0}, {DATA}),
    "settings": ({"methods": ["layer"], "settings": {"layer": {"points": 40}}}, ALL),
    "contact_edges": ({"contact_edges": True}, ALL),
    "interface": ({"interface": BODIES | {"lambda_0": 1e-3, "g_0": 1e-6}}, ALL),
    "studies": ({"studies": SCENE["studies"] | {"more": {"product": PRODUCT}}}, {DATA, PAGE}),
    "figures": (figures(title="other"), {DATA, "one"}),
    "claims": ({"claims": {"closed_forms_agree": ["short"]}}, {DATA}),
    "study.product": (studies(product={**PRODUCT, "m": [3, 5]}), {DATA, PAGE, "two"}),
    "study.cases": ({"studies": {**SCENE["studies"], "long": {"cases": [PRODUCT]}}}, {DATA, PAGE, "two"}),
    "study.trace": (studies(), set()),  # below: its heights
    "study.loads": (studies(loads=[0.1]), {DATA, PAGE, "two"}),
    "study.methods": (studies(methods=["archard"]), {DATA, PAGE, "two"}),
    "study.settings": (studies(methods=["layer"], settings={"layer": {"points": 40}}), {DATA, PAGE, "two"}),
    "figure.draw": (figures(draw="resistance"), {DATA, "one"}),
    "figure.studies": (figures(studies=["long"]), {DATA, "one"}),
    "figure.title": (figures(title="other"), {DATA, "one"}),
    "figure.x": (figures(x="linear"), {DATA, "one"}),
    "figure.y": (figures(y={"to": 3.0}), {DATA, "one"}),
    "figure.size": (figures(size=[3.5, 3]), {DATA, "one"}),
    "figure.colour": (figures(colour="m"), {DATA, "one"}),
    "figure.facet": (figures(facet="m"), {DATA, "one"}),
    "figure.median over": (figures(**{"median over": ["m"]}), {DATA, "one"}),
    "figure.band": (figures(band="all"), {DATA, "one"}),
    "figure.behind": (figures(behind=["long"]), {DATA, "one"}),
}


@pytest.mark.parametrize("key", KEYS)
def test_another_value_of_a_key_makes_its_products_again(tmp_path, key):
    changes, expected = KEYS[key]
    before, after = digests_of(tmp_path), digests_of(tmp_path, **changes)
    assert {name for name in ALL if before[name] != after[name]} == expected
    assert digests_of(tmp_path) == before


def test_each_key_of_a_scene_is_above():
    from weier.scene.models import FigureKeys, SceneKeys, StudyKeys

    known = {
        f"{part}{key}"
        for part, of in (("", SceneKeys), ("study.", StudyKeys), ("figure.", FigureKeys))
        for key in of.keys()  # noqa: SIM118 - a method of models
    }
    assert known == KEYS.keys()


def test_other_heights_of_a_trace_make_again_what_reads_them(tmp_path):
    own = {"line": {"trace": {"file": "line.csv", "length": 1e-3, "height_unit": "um"}, "methods": ["bem"]}}
    changes = {
        "studies": SCENE["studies"] | own,
        "figures": {**SCENE["figures"], "three": {"draw": "compliance", "studies": ["line"]}},
    }
    found = []
    for first in (0, 1.75):
        (tmp_path / "line.csv").write_text("\n".join(map(str, [first, 1, 0.5, -1, 2, 0.25, -0.5, 1.5] * 2)))
        found.append(digests_of(tmp_path, **changes))
    assert {name for name in found[0] if found[0][name] != found[1][name]} == {DATA, PAGE, "three"}


def test_data_of_another_date_are_other_data(tmp_path, monkeypatch):
    """Figures and the explorer have no dates."""
    found = []
    for date in ("", "1000000000", "2000000000"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
        found.append(digests_of(tmp_path))
    assert len({one[DATA] for one in found}) == 3
    assert all(len({one[name] for one in found}) == 1 for name in ALL - {DATA})


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        (("figures",), ALL - {DATA}),
        (("data",), ALL),
        (("pipeline",), ALL),
        (digests.CURVES, ALL),
        (("cli", "accuracy"), set()),
    ],
)
def test_other_code_makes_again_what_it_makes(tmp_path, monkeypatch, parts, expected):
    before, usual = digests_of(tmp_path), digests.digest_of_modules

    def edited(*asked, **options):
        return usual(*asked, **options)[::-1] if {*asked} & {*parts} else usual(*asked, **options)

    for module in (digests, products):
        monkeypatch.setattr(module, "digest_of_modules", edited)
    after = digests_of(tmp_path)
    assert {name for name in ALL if before[name] != after[name]} == expected


@pytest.fixture
def made(tmp_path):
    """A folder with a figure, and a function that asks for its stamp."""
    for file in files_of("one"):
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text(file)

    def ask(digest="a"):
        stamp, fresh = stamp_of(tmp_path, "one", digest)
        return stamp, stamp.exists(), fresh

    return ask


def begin(stamp):
    stamp.parent.mkdir(parents=True, exist_ok=True)
    stamp.touch()


def test_a_stamp_goes_from_missing_to_empty_to_filled(made, tmp_path):
    stamp, exists, fresh = made()
    assert (stamp, exists, fresh) == (tmp_path / ".made_of/one/a", False, False)
    begin(stamp)
    assert made() == (stamp, True, False)  # as a job leaves it that is killed before the product
    fill_stamp(stamp)
    assert made() == (stamp, True, True)
    other, *state = made("b")
    assert (other.name, state) == ("b", [False, False])
    begin(other)
    fill_stamp(other)
    assert [path.name for path in stamp.parent.iterdir()] == ["b"]  # so that the way back makes it again
    assert made("a")[1:] == (False, False)


@pytest.mark.parametrize("file", files_of("one"))
@pytest.mark.parametrize("lost", [False, True])
def test_an_edited_file_asks_for_a_stamp_that_is_missing(made, tmp_path, file, lost):
    stamp = made()[0]
    begin(stamp)
    fill_stamp(stamp)
    (tmp_path / file).unlink() if lost else (tmp_path / file).write_text("edited")
    edited, exists, fresh = made()
    assert (edited.name.partition(".")[0], exists, fresh) == ("a", False, False)
    assert made()[0] == edited  # in each plan the same one
    begin(edited)
    assert made() == (edited, True, False)
    (tmp_path / file).write_text(file)
    fill_stamp(edited)
    assert made() == (edited, True, True)
    (tmp_path / file).write_text("edited again")
    assert made()[0] not in (stamp, edited)


def test_a_stamp_that_was_copied_with_its_files_counts(made, tmp_path):
    stamp = made()[0]
    begin(stamp)
    fill_stamp(stamp)
    copy = tmp_path / "copy"
    for path in (stamp, *(tmp_path / file for file in files_of("one"))):
        (copy / path.relative_to(tmp_path)).parent.mkdir(parents=True, exist_ok=True)
        (copy / path.relative_to(tmp_path)).write_bytes(path.read_bytes())
    assert stamp_of(copy, "one", "a") == (copy / ".made_of/one/a", True)
