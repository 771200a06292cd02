"""Studies of random lines: those of `weier.gaussian`, one case per seed, and an ensemble like phases."""

import numpy as np
import pytest

from tests.scenes import scene_in, solve_scene, write_data
from weier import gaussian, open_dataset, scene, solve
from weier.figures import many_curves, scene_checks
from weier.pipeline.gather import read_study
from weier.scene.figure import Grouping

LINES = {"hurst": 0.8, "length": "1 mm", "shortest": "100 um", "rolloff": 5e-4, "rms_height": 4e-7, "seed": [3, 0, 1]}
OTHERWISE = {"hurst": "0.80", "length": 1e-3, "shortest": "0.1 mm", "rolloff": "0.5 mm", "rms_height": "4e-7 m"}
CHANGES = [{"hurst": 0.7}, {"length": 2e-3}, {"shortest": 5e-5}, {"rolloff": 1e-3}, {"rms_height": 5e-7}]
LOADS = [0.05, 0.4, 1.0]


def load(folder, **studies):
    studies = {name: {"random": lines} for name, lines in studies.items()}
    figure = {"draw": "compliance", "studies": [*studies], "median over": "trace"}
    values = {"title": "t", "loads": LOADS, "methods": ["patches"], "studies": studies, "figures": {"f": figure}}
    return scene_in(folder, values, scene_checks.load_scene)


def line_of(seed, **changes):
    return gaussian(
        **{**OTHERWISE, "hurst": 0.8, "shortest": 1e-4, "rolloff": 5e-4, "rms_height": 4e-7} | changes, seed=seed
    )


def test_each_seed_is_the_line_of_the_library_and_all_are_one_ensemble(tmp_path):
    solutions = solve_scene(load(tmp_path, rough=LINES), tmp_path / "curves")
    write_data(solutions, tmp_path / "contact.nc")
    lines = [line_of(seed) for seed in LINES["seed"]]
    expected = solve(lines, LOADS, method="patches")
    with open_dataset(tmp_path / "contact.nc") as data:
        assert data.trace.values.tolist() == [f"H = 0.8, roll-off 0.0005 m, seed {seed}" for seed in (3, 0, 1)]
        assert data.trace_digest.values.tolist() == [line.digest for line in lines]
        for name in ("compliance", "resistance", "contact_fraction"):
            np.testing.assert_array_equal(data[name].values.ravel(), expected[name].values.ravel())
        assert {*data.trace_hurst.values} == {0.8}
        table = data.weier.ensemble()
        assert table.cases.tolist() == [3] * len(LOADS)
        np.testing.assert_allclose(table.compliance_mean, expected.compliance.values.reshape(3, -1).mean(axis=0))
    drawn = many_curves.draw([read_study(solutions, "rough")], "t", "compliance", Grouping(median_over=("trace",)))
    assert len(drawn.axes[0].collections) == 1  # the band


def keys_of(folder, **changes):
    return [case.surface_key for case in load(folder, rough=LINES | changes).studies["rough"]]


def test_parameters_identify_a_line_however_they_are_written(tmp_path):
    keys = keys_of(tmp_path)
    assert len({*keys}) == 3
    assert keys_of(tmp_path, **OTHERWISE, seed=[3, {"from": 0, "to": 1, "count": 2}]) == keys
    whole = keys_of(tmp_path, rolloff="1 mm")
    scene = load(tmp_path, rough={name: value for name, value in LINES.items() if name != "rolloff"})
    assert [case.surface_key for case in scene.studies["rough"]] == whole
    for changes in CHANGES:
        assert not {*keys} & {*keys_of(tmp_path, **changes)}, changes


def test_lines_of_other_parameters_are_no_median_and_no_ensemble(tmp_path):
    rougher = LINES | {"hurst": 0.6}
    with pytest.raises(scene.SceneError, match="would mix random lines of other parameters"):
        load(tmp_path, rough=LINES, rougher=rougher)
    load(tmp_path, rough=LINES, more=LINES | {"seed": 7})
    lines = [line_of(seed, **changes) for changes in CHANGES for seed in (0, 1)]
    assert solve([line_of(0), line_of(1), *lines], [0.1]).weier.ensemble().cases.tolist() == [2] * (1 + len(CHANGES))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"hurst": 1.5}, r"random: hurst must lie in \(0, 1\), got 1.5$"),
        ({"rms_slope": 0.1}, "random: one of rms_height and rms_slope must be given, got both or neither$"),
        ({"roll_off": 1e-4}, r"random.roll_off: Extra inputs are not permitted: the documentation"),
    ],
)
def test_a_mistake_is_one_sentence_with_its_line(tmp_path, changes, says):
    with pytest.raises(scene.SceneError, match=r"scene.yaml, line \d+: studies.rough\." + says):
        load(tmp_path, rough=LINES | changes)
