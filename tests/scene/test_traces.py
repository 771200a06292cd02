"""Studies of measured heights: a file beside the scene, whose content counts."""

import re

import numpy as np
import pytest

from tests.scenes import scene_in, solve_scene, write_data
from weier import Trace, open_dataset, scene
from weier.data.variables import Status
from weier.figures import many_curves, scene_checks
from weier.pipeline.gather import read_study
from weier.scene import Case

X = 1e-6 * np.arange(64)
HEIGHTS = 1e-6 * np.cos(2 * np.pi * X / 64e-6) + 2e-7 * np.sin(2 * np.pi * X / 16e-6)
OPTIONS = {"file": "shaft.csv", "shortest": "8e-6", "ends": "periodic", "unit": "m"}
BODIES = dict.fromkeys(("mu_1", "mu_2"), 8.0e10) | dict.fromkeys(("nu_1", "nu_2"), 0.3)
BODIES |= dict.fromkeys(("rho_1", "rho_2"), 2e-7)
SCENE = {
    "title": "t",
    "loads": [0.1, 1.0],
    "methods": ["bem", "demelio"],
    "studies": {
        "mine": {"trace": OPTIONS, "methods": ["bem"]},
        "series": {"product": {"D": 1.5, "gamma": 2, "m": 2}},
    },
    "figures": {"f": {"draw": "compliance", "studies": ["mine", "series"]}},
}


def write_heights(path, heights=HEIGHTS):
    np.savetxt(path, np.column_stack([X, heights]), delimiter=",", header="x,z", comments="")


def load(folder, **changes):
    return scene_in(folder, SCENE | changes, scene_checks.load_scene)


@pytest.fixture
def folder(tmp_path):
    write_heights(tmp_path / "shaft.csv")
    return tmp_path


def test_a_trace_is_read_as_by_the_library_and_is_the_same_case_in_memory(folder):
    (case,) = load(folder).studies["mine"]
    expected = Trace.read(folder / "shaft.csv", shortest=8e-6, ends="periodic", unit="m")
    assert case.profile.labels == expected.labels
    same = Case(expected.parameters, ("bem",), {}, expected)
    assert same.surface_key == case.surface_key


def test_two_rough_bodies_are_the_sum_of_two_files(folder):
    """The key of scenes and the option of the shell."""
    write_heights(folder / "bush.csv", HEIGHTS[::-1])
    write_heights(folder / "liner.csv", 0.3 * HEIGHTS + 1e-7 * np.cos(2 * np.pi * X / 8e-6))
    study = {"trace": OPTIONS | {"file": ["shaft.csv", "bush.csv"], "against": "liner.csv"}, "methods": ["bem"]}
    cases = [*load(folder, studies={"pairs": study}, figures={}).studies["pairs"]]
    shaft, bush, liner = (
        Trace.read(folder / f"{name}.csv", shortest=8e-6, ends="periodic", unit="m")
        for name in ("shaft", "bush", "liner")
    )
    for case, one in zip(cases, (shaft, bush), strict=True):
        gap = Trace.between(one, liner)
        assert case.profile.labels == gap.labels
        np.testing.assert_array_equal(case.profile.amplitude, gap.amplitude)
    write_heights(folder / "liner.csv", HEIGHTS)
    with pytest.raises(ValueError, match=r"shaft\.csv or .*liner\.csv has changed since its scene was read"):
        _ = Case(cases[0].parameters, ("bem",), {}).profile


def sources(study):
    return [case.profile.source for case in study]


def test_a_pattern_is_its_files_in_natural_order(folder):
    (folder / "lab" / "day").mkdir(parents=True)
    (folder / "lab" / "notes.txt").write_text("none")
    (folder / "lab" / ".line 1.csv").write_text("hidden")
    for number in (10, 2, 1):
        write_heights(folder / "lab" / f"line {number}.csv", HEIGHTS + 1e-9 * number * np.sin(2 * np.pi * X / 32e-6))
    write_heights(folder / "lab" / "day" / "line 3.csv")
    batch = {"trace": OPTIONS | {"file": "lab/*.csv"}, "methods": ["bem"]}
    deep = {"trace": OPTIONS | {"file": ["lab/**/line 3.csv", "lab/line [12].csv"]}, "methods": ["bem"]}
    loaded = load(folder, studies={"batch": batch, "deep": deep}, figures={})
    assert sources(loaded.studies["batch"]) == [f"lab/line {number}.csv" for number in (1, 2, 10)]
    assert sources(loaded.studies["deep"]) == ["lab/day/line 3.csv", "lab/line 1.csv", "lab/line 2.csv"]
    (folder / "lab" / "line 11.csv").write_text("x,z\n0,1.5\n1,rough\n")
    with pytest.raises(scene.SceneError, match=r"trace\.file\.0: [^,]*lab/line 11\.csv, line 3, "):
        load(folder, studies={"batch": batch}, figures={})
    with pytest.raises(scene.SceneError, match=r"trace\.file\.0: there is no file .*lab/\*\.dat"):
        load(folder, studies={"batch": {"trace": OPTIONS | {"file": "lab/*.dat"}, "methods": ["bem"]}}, figures={})


def test_several_shortest_wavelengths_are_a_product_with_the_files(folder):
    write_heights(folder / "other.csv", HEIGHTS[::-1])
    options = OPTIONS | {"file": ["shaft.csv", "other.csv"], "shortest": ["8e-6", 3.2e-5]}
    loaded = load(folder, studies={"both": {"trace": options, "methods": ["bem"]}}, figures={})
    traces = [case.profile for case in loaded.studies["both"]]
    assert [(trace.source, trace.shortest) for trace in traces] == [
        ("shaft.csv", 8e-6),
        ("shaft.csv", 3.2e-5),
        ("other.csv", 8e-6),
        ("other.csv", 3.2e-5),
    ]
    assert len(loaded.distinct) == 4


def test_what_the_file_holds_counts_and_not_where_it_is(folder, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (case,), copied = load(folder).studies["mine"], elsewhere / "shaft.csv"
    copied.write_bytes((folder / "shaft.csv").read_bytes())
    (same,) = load(elsewhere).studies["mine"]
    assert same.surface_key == case.surface_key
    write_heights(copied, HEIGHTS + 1e-9 * (np.arange(64) == 5))
    (changed,) = load(elsewhere).studies["mine"]
    assert changed.surface_key != case.surface_key


def test_curves_of_a_trace_go_through_files_beside_those_of_a_series(folder):
    """To one file and to memory; methods of the series alone have no curve of a trace."""
    loaded = load(folder, studies=SCENE["studies"] | {"mine": {"trace": OPTIONS}})
    solutions = solve_scene(loaded, folder / "curves")
    write_data(solutions, folder / "contact.nc")
    trace = next(iter(loaded.studies["mine"])).profile
    with open_dataset(folder / "contact.nc") as data:
        assert data["trace_digest"].values.tolist() == [trace.digest, ""]
        np.testing.assert_array_equal(data["trace_length"], [trace.lambda_0, np.nan])
        assert data["status"].values.tolist() == [[Status.solved, Status.not_applicable], [Status.solved] * 2]
        assert np.isfinite(data["compliance"].values).all(axis=2).tolist() == [[True, False], [True, True]]
        assert re.fullmatch(r"mine: trace = shaft\.csv, m = 2, trace_digest = [0-9a-f]{12}", data.case.values[0])
        assert data.weier.cases(trace="shaft.csv").sizes["case"] == 1
    studies = [read_study(solutions, name) for name in ("mine", "series")]
    drawn = many_curves.draw(studies, "t", "compliance")
    assert "(b)  shaft.csv" in [axes.get_title() for axes in drawn.axes]


def mine(methods=("bem",), **options):
    return {"studies": {"mine": {"trace": OPTIONS | options, "methods": list(methods)}}, "figures": {}}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (mine(file="scene.yaml"), r"studies\.mine\.trace\.file\.0: .*line \d+, "),
        (mine(missing=5), r"studies\.mine\.trace\.missing: Extra inputs are not permitted: the documentation"),
        (mine(["demelio"]), r'studies\.mine: method "demelio" is for the Weierstrass series, .*weier\.fit'),
        (
            {"figures": {"f": {"draw": "compliance", "studies": ["mine", "series"], "colour": "method"}}},
            r"figures\.f: trace varies .* nothing shows it: add trace to colour",
        ),
    ],
)
def test_a_mistake_is_reported_with_its_line(folder, changes, message):
    path = re.escape(str(folder / "scene.yaml"))
    with pytest.raises(scene.SceneError, match=rf"^{path}, line \d+: {message}"):
        load(folder, **changes)
