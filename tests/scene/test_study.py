"""Studies know their cases without making all of them."""

import itertools
import json

import pytest

from tests.scenes import scene_in
from weier import scene
from weier.scene.study import CaseProduct, Study

AXES = {"D": [1.25, 1.5], "gamma": [2, "5/2", 3], "m": [1, 2, 3], "seed": [0, 1]}
# Products that meet in some cases, repeat a value, or differ in nothing but methods or settings.
OVERLAPPING = {
    "all": {"product": AXES},
    "some": {"product": {"seed": [1, 7, 1], "m": 2, "gamma": [3, "5/2", 4], "D": 1.5}},
    "one_by_one": {"cases": [{"D": 1.5, "gamma": 3, "m": 2, "seed": 7}, AXES | {"m": [3, 4]}, AXES | {"D": 1.25}]},
    "other_methods": {"product": AXES | {"m": 2}, "methods": ["archard", "layer"]},
    "other_settings": {"product": AXES | {"m": 2}, "settings": {"layer": {"points": 40}}},
    "phases": {"product": {"D": 1.25, "gamma": 2, "m": 2, "phases": [0.0, 1.0, [0.0, 1.0], 0.0]}},
    "none": {"product": {"D": 1.25, "gamma": 2, "m": 2}},
}
FINE = {"D": 1.5, "gamma": [2, 100], "m": [2, 4], "seed": 0}
FIELDS = {"title": "test", "loads": [0.1, 1.0], "methods": ["layer"]}


def load(folder, **changes):
    return scene_in(folder, FIELDS | changes)


@pytest.fixture
def overlapping(tmp_path):
    return load(tmp_path, studies=OVERLAPPING)


def test_the_cases_of_a_product_are_its_combinations_in_order():
    cases = CaseProduct(AXES, ("layer",), {})
    expected = [dict(zip(AXES, values, strict=True)) for values in itertools.product(*AXES.values())]
    assert [cases.case(position).parameters for position in range(cases.count)] == expected


def test_a_study_is_a_sequence(overlapping):
    cases = overlapping.study("one_by_one")
    assert len(cases) == len(list(cases)) == 1 + 24 + 18
    assert cases[0] == cases[-43]
    assert list(cases[1:3]) == [cases[1], cases[2]]
    with pytest.raises(IndexError):
        cases[43]
    assert len(Study([])) == 0


def test_cases_have_the_same_identity_if_they_have_the_same_key(overlapping):
    identities = itertools.chain.from_iterable(product.identities for product in overlapping.products)
    pairs = set(zip([case.key for case in Study(overlapping.products)], identities, strict=True))
    assert len(pairs) == len({key for key, _ in pairs}) == len({identity for _, identity in pairs})


def test_every_case_is_there_once_with_its_studies(overlapping):
    """As one finds them by making every case of every study."""
    members = {name: [case.key for case in cases] for name, cases in overlapping.studies.items()}
    homes = {}
    for name, key in ((name, key) for name, keys in members.items() for key in keys):
        homes.setdefault(key, dict.fromkeys([name]))[name] = None
    assert [case.key for case in overlapping.distinct] == list(overlapping.cases) == list(homes)
    assert overlapping.studies_of_cases == [tuple(home) for home in homes.values()]


def test_every_value_of_a_parameter_is_checked(tmp_path):
    """Wherever it stands: each case with a bad one is bad."""
    good = {"D": [1.25, 1.5], "gamma": [2, 3], "m": [1, 2], "seed": [0, 1]}
    for name, bad in {"D": 2.5, "gamma": 0.5, "m": 2.5, "seed": -1}.items():
        with pytest.raises(scene.SceneError, match=f"studies.one.product.{name}: {name} must"):
            load(tmp_path, studies={"one": {"product": good | {name: [*good[name], bad]}}})
    with pytest.raises(scene.SceneError, match="one for each of the m = 3 terms, got 2"):
        load(tmp_path, studies={"one": {"product": {"D": 1.5, "gamma": 2, "m": [2, 3], "phases": [0.0, [0.0, 1.0]]}}})
    with pytest.raises(scene.SceneError, match="at most 100000 times into the period"):
        load(tmp_path, methods=["bem"], studies={"one": {"product": FINE}})


def test_definitions_are_plain(overlapping):
    for product in overlapping.products:
        assert json.loads(json.dumps(product.definition))


def test_the_product_of_a_case_is_the_first_that_has_it(overlapping):
    keys = [{product.case(position).key for position in range(product.count)} for product in overlapping.products]
    for case, number in zip(overlapping.distinct, overlapping.product_of_cases, strict=True):
        assert number == [case.key in own for own in keys].index(True)
