"""What a curve is: its kind, its key, and its place among those that are missing and among jobs."""

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import curves_in, scene_in
from weier.methods import registry
from weier.methods.registry import find_method
from weier.methods.settings import defaults
from weier.pipeline.needed_curves import Curves, share
from weier.pipeline.store import Store
from weier.scene.case import identity

PRODUCT = {"D": [1.25, 1.5], "gamma": [2, 3], "m": 2, "seed": {"from": 1, "to": 3, "count": 3}}
SCENE = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["archard", "bem"],
    "studies": {"one": {"product": PRODUCT}},
}


def product(**changes):
    return {"studies": {"one": {"product": PRODUCT | changes}}}


def lacking(curves):
    return curves.store.lacking(curves.parts_for())


def fill(curves, every=1):
    """Append rows without numbers for what is missing, or for a part of it."""
    for part in lacking(curves):
        curves.store.append(part.kind, {key: {"seconds": 1.0} for key in part.keys[::every]}, "test")


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"title": "another", "studies": {"another": SCENE["studies"]["one"]}}, {}),
        (product(D=["1.5", 1.25], gamma=["6/2", 2.0], m="2", seed=[3, 2]), {}),
        (product(D=[1.25, 1.4, 1.5]), {"surface": 6, "archard": 2, "bem": 6}),
        (product(seed={"from": 0, "to": 3, "count": 4}), {"surface": 4, "bem": 4}),
        ({"methods": ["bem", "persson"]}, {"persson": 4}),
        # A solution goes from load to load, and the bounds of a resistance are chords between them.
        ({"loads": [0.1, 0.5, 1.0]}, {"archard": 4, "bem": 12}),
        ({"contact_edges": True}, {"archard": 4, "bem": 12}),
        ({"studies": {"one": {"product": PRODUCT, "loads": [0.2]}}}, {"archard": 4, "bem": 12}),
    ],
)
def test_only_what_is_missing_is_solved(tmp_path, changes, expected):
    fill(Curves(scene_in(tmp_path, SCENE), Store(tmp_path / "curves", "now")))
    found = {}
    for part in lacking(Curves(scene_in(tmp_path, SCENE | changes), Store(tmp_path / "curves", "now"))):
        found[part.kind.method] = found.get(part.kind.method, 0) + len(part.keys)
    assert found == expected


def test_the_same_value_is_one_however_it_is_written():
    for name, values in {
        "gamma": ("10/2", 5, 5.0, "5", "15/3"),
        "D": (1.25, "1.25", "125e-2"),
        "m": (2, 2.0, "2"),
        "phases": ([0, 1], [0.0, 1.0], (0, "1")),
    }.items():
        assert len({repr(identity(name, value)) for value in values}) == 1, name
    assert identity("gamma", 2.5) == identity("gamma", "5/2") != identity("gamma", "5/3")
    assert identity("seed", 2**53) != identity("seed", 2**53 + 1)
    assert identity("m", np.inf) == np.inf


def names(folder, **changes):
    """The kinds of curves, and the keys of the surfaces, of a scene."""
    found = curves_in(scene_in(folder, SCENE | changes), folder)
    return {part.kind.method: part.kind.name for part in found.parts}, [part.keys.tolist() for part in found.surfaces]


def test_another_setting_or_default_is_another_kind_and_another_order_of_phases_another_surface(
    tmp_path, monkeypatch
):
    method = find_method("layer")
    usual = defaults(method)["points"]
    kinds = [names(tmp_path, methods=["layer"], settings={"layer": {"points": n}})[0] for n in (usual, usual + 1)]
    assert kinds[0] == names(tmp_path, methods=["layer"])[0] != kinds[1]
    points = method.settings["points"]._replace(default=usual + 1)
    changed = replace(method, settings={**method.settings, "points": points})
    monkeypatch.setattr(registry, "METHODS", tuple(changed if one is method else one for one in registry.METHODS))
    assert names(tmp_path, methods=["layer"])[0] == kinds[1]
    one = {"D": 1.25, "gamma": 2, "m": 3}
    studies = [{"one": {"product": one | {"phases": [phases]}}} for phases in ([0, 1, 2], [0, 2, 1])]
    assert names(tmp_path, studies=studies[0])[1] != names(tmp_path, studies=studies[1])[1]


def named(parts):
    return [(part.kind.name, key) for part in parts for key in part.keys.tolist()]


def test_jobs_share_the_seconds_of_curves_whatever_others_have_solved_meanwhile(tmp_path):
    """Each curve once, also one that two studies have, and curves of one kind by different jobs."""
    long = {"product": PRODUCT | {"m": [1, 2, 3, 4], "seed": {"from": 1, "to": 10, "count": 10}}}
    scene = scene_in(tmp_path, SCENE | {"studies": {"one": SCENE["studies"]["one"], "long": long}})
    full = curves_in(scene, tmp_path / "curves")
    planned = lacking(full)
    shares = [[full.store.lacking(share(full.parts_for(), number, 3)) for number in range(3)]]
    assert sorted(key for own in shares[0] for key in named(own)) == sorted(named(planned))
    seconds = [sum(part.seconds.sum() for part in own) for own in shares[0]]
    longest = max(part.seconds.max() for part in planned)
    assert max(seconds) - min(seconds) <= longest < 0.1 * min(seconds)
    fill(full, every=2)  # by others, in part
    shares += [[full.store.lacking(share(full.parts_for(), number, 3)) for number in range(3)]]
    for before, now in zip(*shares, strict=True):
        assert set() < set(named(now)) < set(named(before))


def test_jobs_share_the_curves_of_one_more_seed(tmp_path):
    """As the others are solved, the order of cases would deal all of them to one job."""

    def curves(seeds):
        changes = product(D=np.linspace(1.1, 1.9, 9).tolist(), seed={"from": 1, "to": seeds, "count": seeds})
        return curves_in(scene_in(tmp_path, SCENE | {"methods": ["bem"]} | changes), tmp_path / "curves")

    fill(curves(39))
    more = curves(40)
    shares = [more.store.lacking(share(more.parts_for(), number, 4)) for number in range(4)]
    own = [sum(len(part.keys) for part in parts if part.kind.method == "bem") for parts in shares]
    assert (sum(own), max(own) <= 9) == (18, True)
