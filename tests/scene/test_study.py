"""Studies know their cases without making all of them."""

import numpy as np
import pytest

from tests.scene.test_traces import BODIES
from tests.scenes import scene_in
from weier import scene
from weier.scene.identity import short_keys

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
LOADS = np.array([0.1, 1.0])
FIELDS = {"title": "test", "loads": [0.1, 1.0], "methods": ["layer"]}


def load(folder, **changes):
    return scene_in(folder, FIELDS | changes)


@pytest.fixture
def overlapping(tmp_path):
    return load(tmp_path, studies=OVERLAPPING)


def test_keys_of_products_are_those_of_their_cases(overlapping):
    for product in overlapping.products:
        cases = [product.case(position) for position in range(product.count)]
        assert short_keys(product.case_keys) == [case.key(LOADS) for case in cases]
        assert np.array_equal(product.surface_keys, [case.surface_key for case in cases])
        assert len({case.key(LOADS) for case in cases}) == len({repr(case) for case in cases})


def test_every_case_is_there_once_with_its_studies(overlapping):
    """As one finds them by making every case of every study."""
    members = {name: [case.key(LOADS) for case in cases] for name, cases in overlapping.studies.items()}
    homes = {}
    for name, key in ((name, key) for name, keys in members.items() for key in keys):
        homes.setdefault(key, dict.fromkeys([name]))[name] = None
    assert [case.key(LOADS) for case in overlapping.distinct] == list(homes)
    assert overlapping.studies_of_cases == [", ".join(home) for home in homes.values()]


def test_a_study_has_its_own_loads(tmp_path):
    """Of which the file has all; cases at other loads are other cases, and units must agree."""
    product = {"D": 1.5, "gamma": 2, "m": 2}
    studies = {"own": {"product": product, "loads": [0.2, 1.0]}, "common": {"product": product}}
    loaded = load(tmp_path, studies=studies)
    assert loaded.studies["own"].products[0].loads.tolist() == [0.2, 1.0]
    assert loaded.studies["common"].products[0].loads.tolist() == [0.1, 1.0]
    assert loaded.loads.tolist() == [0.1, 0.2, 1.0]
    assert len(loaded.distinct) == 2
    assert len(load(tmp_path, studies=studies | {"own": studies["own"] | {"loads": [1.0, 0.1]}}).distinct) == 1
    bodies = BODIES | {"lambda_0": 1e-3, "g_0": 1e-6}
    with pytest.raises(
        scene.SceneError, match=r"studies\.own\.loads: loads of a study must be in the unit of .* MPa"
    ):
        load(tmp_path, interface=bodies, studies=studies | {"own": {"product": product, "loads": ["1 MPa"]}})
    with pytest.raises(scene.SceneError, match=r"studies\.own\.loads: loads of a study must be in the unit of "):
        load(tmp_path, interface=bodies, loads=["2 MPa"], studies=studies)
