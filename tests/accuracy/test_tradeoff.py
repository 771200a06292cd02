"""The measured trade: errors against the reference, who is on the front, what is written."""

from importlib import import_module

import numpy as np
import pytest

from weier import Profile, figures, scene
from weier.accuracy import tradeoff
from weier.accuracy.tradeoff.fit import constants
from weier.accuracy.tradeoff.numbers import pareto, seconds_per_load, worst_over_loads
from weier.data import dataset
from weier.methods import bem, patches
from weier.methods.registry import method_named
from weier.methods.settings import check_names

SCENE = """
title: Small
loads: [0.01, 0.1, 2.0]
methods: [patches]
studies:
  profiles:
    cases:
      - {D: 1.25, gamma: 5, m: 1}
      - {D: 1.5, gamma: 3, m: 2, phase: 1.0}
"""


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "small.yaml"
    path.write_text(SCENE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(import_module("weier.methods.bem.method"), "MAX_POINTS_COMPARED", 600)
        return tradeoff.measure(scene.load(path))


def error(measured, name, case=1, quantity="compliance"):
    return worst_over_loads(measured, quantity)[case, measured["solution_method"].values.tolist().index(name)]


def test_errors_fall_with_points_and_are_those_of_the_reference(measured):
    assert error(measured, "bem 24") / error(measured, "bem 96") == pytest.approx(16, rel=0.5)
    assert error(measured, "layer 24") > 100 * error(measured, "bem 96")
    assert error(measured, "patches 1e-06") < 1e-8
    assert np.isnan(error(measured, tradeoff.REFERENCE))
    # One wave is Westergaard's: the closed forms tell how exact the reference is.
    assert error(measured, "archard", case=0) < 1e-13


def test_a_grid_too_fine_for_a_profile_is_left_out(measured):
    run = np.isfinite(seconds_per_load(measured))
    names = measured["solution_method"].values.tolist()
    assert run[:, names.index("bem 384")].tolist() == [True, False]
    assert run[:, names.index("bem 96")].all()
    assert np.isnan(error(measured, "bem 384"))


def test_every_contender_is_a_method_with_its_settings(measured):
    for contender in tradeoff.contenders(Profile(1.25, 5, 2)):
        check_names(method_named(contender.method), contender.settings)
        assert len(contender.name) <= 16


def test_shipped_laws_bound_what_is_measured(measured):
    found = {constant.name: constant for constant in constants(measured)}
    assert {"BEM_COMPLIANCE", "PATCHES_RESISTANCE", "DEMELIO", "SECONDS_NODE bem", "SECONDS_CONTACT"} <= found.keys()
    bounds = [constant for constant in found.values() if constant.bound]
    assert [constant for constant in bounds if not constant.measured <= constant.shipped] == []
    # And not by far: this is of order 2 on any grid and profile.
    assert found["BEM_COMPLIANCE"].measured > found["BEM_COMPLIANCE"].shipped / 5


def test_a_fit_finds_the_laws_that_made_the_data(measured):
    seconds = measured["seconds"].copy(deep=True)
    names = measured["solution_method"].values.tolist()
    for at, name in enumerate(names):
        for case in range(2):
            points, contacts = measured["points"].values[case, at], measured["patch_count"].values[case, at]
            if name.startswith("bem"):
                start, load = bem.error_model.seconds(points, contacts)
                seconds.values[case, at] = start + load.sum()
            if name.startswith("patches"):
                waves = [1, 3][case]
                seconds.values[case, at] = (
                    patches.error_model.SECONDS_START + patches.error_model.seconds(waves, contacts).sum()
                )
    found = {c.name: c for c in constants(measured.assign(seconds=seconds)) if not c.bound}
    for name in ("SECONDS_LOAD bem", "SECONDS_NODE bem"):
        assert found[name].measured == pytest.approx(found[name].shipped, rel=1e-6)


@pytest.mark.parametrize(
    ("cost", "error", "front"),
    [
        ([1, 2, 3], [3, 2, 1], [0, 1, 2]),
        ([1, 2, 3], [1, 2, 0.5], [0, 2]),
        ([3, 2, 1], [1, 1, 1], [2]),
        ([1, np.nan, 2], [2, 0, np.nan], [0]),
        ([1, 1], [2, 1], [1]),
    ],
)
def test_the_front_is_what_nothing_beats(cost, error, front):
    assert pareto(np.array(cost, float), np.array(error, float)) == front


def test_files_table_and_figure(measured, tmp_path):
    dataset.write(measured, tmp_path / "tradeoff.nc", "Small")
    again = dataset.read(tmp_path / "tradeoff.nc")
    assert again["seconds"].values == pytest.approx(measured["seconds"].values, nan_ok=True)
    assert again["phase"].values[1, 1] == 1.0
    tradeoff.write_table(again, "Small", tmp_path / "tradeoff.md")
    text = (tmp_path / "tradeoff.md").read_text()
    assert text.startswith("# Small")
    assert text.count("| bem ") == sum(name.startswith("bem") for name in measured["solution_method"].values.tolist())
    figures.draw("work_precision", [again], "", tmp_path / "figure.png")
    assert (tmp_path / "figure.svg").exists()
    with pytest.raises(ValueError, match="no times"):
        figures.draw("work_precision", [again.assign(seconds=again["seconds"] * np.nan)], "", tmp_path / "none.png")
