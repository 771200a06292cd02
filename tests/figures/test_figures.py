"""Figures: the same bytes for the same data, from whatever a scene's studies hold or lack."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from weier import figures, scene
from weier.data import dataset
from weier.data.dataset import Status
from weier.figures import style, truncated_compliance
from weier.figures.captions import CAPTIONS, caption
from weier.pipeline import batch, curves
from weier.pipeline import gather as study

SCENE = """
title: Small
loads: [0.02, 0.3, 1.5]
methods: [archard, demelio, bem, patches]
settings: {bem: {points: 64}}
contact_edges: true
studies:
  terms:
    product: {D: 1.25, gamma: 3, m: [1, 2], phase: 1.0}
  one:
    product: {D: 1.5, gamma: "5/2", m: 2, phase: 1.0}
"""
FORMATS = ("pdf", "svg", "png")


@pytest.fixture(scope="module")
def studies(tmp_path_factory: pytest.TempPathFactory) -> dict[str, xr.Dataset]:
    folder = tmp_path_factory.mktemp("scene")
    (folder / "small.yaml").write_text(SCENE)
    loaded = scene.load(folder / "small.yaml")
    parts = {folder / f"{name}.nc": batch.solve_batch(loaded, cases)[0] for name, cases in loaded.batches.items()}
    for path, data in parts.items():
        dataset.write(data, path, "small")
    found = {}
    for name, cases in loaded.studies.items():
        keys = [case.key for case in cases]
        study.gather(list(parts), keys, folder / "study.nc", name, change=study.add_bounds)
        found[name] = dataset.read(folder / "study.nc")
    return found


def endless_many(methods: tuple[str, ...] = ("archard", "patches", "new")) -> xr.Dataset:
    """Smooth curves of more cases than have panels: m up to 8 and infinite, a method unsolved, one unknown."""
    loads = np.geomspace(0.01, 10, 7)
    data = dataset.blank(9, methods, loads, 8, edges=4)
    data["contact_edge"].values[3, :-1, :2] = 0.1, 1.2  # over the end of the period; the last load is full contact
    for case, m in enumerate([1, 2, 3, 4, 5, 6, 7, 8, np.inf]):
        data["key"].values[case] = f"case{case}"
        data["D"].values[case], data["gamma"].values[case], data["m"].values[case] = 1.5, 2, m
        data["total_amplitude"].values[case], data["tail_amplitude"].values[case] = 1 + 0.1 * case, 0.1
        data["phase"].values[case, : int(min(m, 8))] = 0.5
        for row in range(case == 0, 3):
            data["compliance"].values[case, row] = (1 + 0.1 * case) * -np.expm1(-loads * (1 + row))
            data["resistance"].values[case, row] = np.exp(-loads * (1 + row))
            data["status"].values[case, row] = Status.solved
    return data


def drawn(kind: str, given: list[xr.Dataset], folder: Path) -> list[bytes]:
    figures.draw(kind, given, "A title", folder / "figure.pdf")
    return [(folder / f"figure.{suffix}").read_bytes() for suffix in FORMATS]


def sketch(kind: str, given: list[xr.Dataset]) -> Figure:
    """A figure laid out but not saved; whatever goes wrong in drawing goes wrong here."""
    figure: Figure = import_module(f"weier.figures.{kind}").draw(given, "")
    figure.draw_without_rendering()
    return figure


@pytest.mark.parametrize("kind", figures.KINDS)
def test_same_data_same_bytes(kind: str, studies: dict[str, xr.Dataset], tmp_path: Path) -> None:
    first = drawn(kind, [studies["one"]], tmp_path)
    assert first == drawn(kind, [studies["one"]], tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["figure.pdf", "figure.png", "figure.svg"]
    assert first[0].startswith(b"%PDF")
    assert b"<svg" in first[1]
    assert first[2].startswith(b"\x89PNG")
    assert b"CreationDate" not in first[0]
    assert b"dc:date" not in first[1]


@pytest.mark.parametrize("kind", figures.KINDS)
def test_several_studies(kind: str, studies: dict[str, xr.Dataset]) -> None:
    assert sketch(kind, list(studies.values())).axes


@pytest.mark.parametrize("kind", figures.KINDS)
def test_many_cases_with_holes(kind: str) -> None:
    sketch(kind, [endless_many()])


@pytest.mark.parametrize("kind", [kind for kind in figures.KINDS if kind not in ("borodich_galanov", "profiles")])
def test_nothing_to_draw(kind: str, tmp_path: Path) -> None:
    empty = dataset.blank(2, ["archard", "bem"], np.array([0.1, 1.0]), 2)
    with pytest.raises(ValueError, match="there are no "):
        figures.draw(kind, [empty], "", tmp_path / "figure.pdf")
    assert not list(tmp_path.iterdir())


def test_endless_series_has_no_profile(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no profiles"):
        figures.draw("profiles", [endless_many().isel(case=[8])], "", tmp_path / "figure.pdf")


@pytest.mark.parametrize(
    "kind", ["compliance", "resistance", "phases", "truncated_compliance", "truncated_resistance"]
)
def test_one_load(kind: str, studies: dict[str, xr.Dataset]) -> None:
    sketch(kind, [studies["one"].isel(mean_pressure=[1])])


def test_unknown_kind(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no figure 'style'.*borodich_galanov, compliance"):
        figures.draw("style", [], "", tmp_path / "figure.pdf")


def test_kinds_are_the_modules() -> None:
    modules = {path.stem for path in Path(figures.__file__).parent.glob("*.py")}
    assert modules - {*figures.KINDS, *figures.MEASURES} == {"__init__", "captions", "methods", "style", "truncation"}


def test_every_kind_has_a_caption() -> None:
    assert set(CAPTIONS) == {*figures.KINDS, *figures.MEASURES}


CAPTIONED = """
title: Captions
loads: [0.1]
methods: [layer]
studies:
  bare: {product: {D: 1.5, gamma: 5, m: 2}}
  elements: {product: {D: 1.5, gamma: 5, m: 2}, methods: [layer, bem]}
  both: {product: {D: 1.5, gamma: 5, m: 2}, methods: [bem, patches]}
  many: {product: {D: 1.5, gamma: 5, m: [1, 2, 3, 4, 5]}, methods: [bem, patches]}
figures:
  figure_1: {draw: profiles, studies: [bare], title: Rough <and> smooth}
  bare: {draw: compliance, studies: [bare]}
  elements: {draw: compliance, studies: [elements]}
  both: {draw: resistance, studies: [both]}
  many: {draw: resistance, studies: [many]}
"""


def test_a_caption_says_what_is_drawn(tmp_path: Path) -> None:
    (tmp_path / "captioned.yaml").write_text(CAPTIONED)
    loaded = scene.load(tmp_path / "captioned.yaml")
    name, text, seen = caption(loaded, "figure_1")
    assert (name, text) == ("Figure 1", f"Rough <and> smooth. {CAPTIONS['profiles']}")
    assert seen == "Figure 1: The profiles over two of their longest waves"
    drawn = {
        name: re.split(r": |\. ", caption(loaded, name).text)[1] for name in ("bare", "elements", "both", "many")
    }
    assert drawn == {
        "bare": "the estimates in colours",
        "elements": "the estimates in colours, boundary elements as a solid black line",
        "both": "contact patches as a solid black line, boundary elements as circles",
        "many": "a thin line for each profile, and a thick one for the median of each method",
    }


def test_failed_drawing_leaves_the_old_file(tmp_path: Path, studies: dict[str, xr.Dataset]) -> None:
    (tmp_path / "figure.pdf").write_text("old")
    with pytest.raises(ValueError, match="no series"):
        figures.draw("phases", [studies["one"].sel(solution_method=["archard"])], "", tmp_path / "figure.pdf")
    assert (tmp_path / "figure.pdf").read_text() == "old"


def test_look_of_the_user_is_left_out(tmp_path: Path) -> None:
    before = drawn("borodich_galanov", [], tmp_path)
    with matplotlib.rc_context({"font.size": 20, "axes.facecolor": "red"}):
        assert drawn("borodich_galanov", [], tmp_path) == before
        assert matplotlib.rcParams["font.size"] == 20


def test_exact_method_is_the_line_and_the_other_points(studies: dict[str, xr.Dataset]) -> None:
    both = studies["one"]
    assert curves.numerical_method(both.isel(case=0)) == "patches"
    assert curves.numerical_method(both.isel(case=0, solution_method=slice(-1))) == "bem"
    (axes,) = sketch("compliance", [both]).axes
    styles = {line.get_label(): line.get_linestyle() for line in axes.get_lines()}
    assert styles["contact patches"] == "-"
    assert styles["boundary elements"] == "None"


def test_boundary_elements_are_points_beside_each_exact_curve(studies: dict[str, xr.Dataset]) -> None:
    for m, values in zip([1, 2], studies["terms"].sel(solution_method="bem")["resistance"].values, strict=True):
        alone = studies["terms"].isel(case=[m - 1])
        lines = sketch("truncated_resistance", [alone]).axes[0].get_lines()
        points, legend = (line.get_ydata() for line in lines if line.get_marker() == "o")
        assert np.array_equal(points, values)
        assert len(legend) == 0
        assert len([each for each in sketch("phases", [alone]).axes[0].get_lines() if each.get_marker() == "o"]) == 2
        without = sketch("truncated_resistance", [alone.sel(solution_method=["bem"])]).axes[0].get_lines()
        assert [line.get_marker() for line in without] == ["None"]


def test_truncated_series_meet_in_the_mean_plane(studies: dict[str, xr.Dataset]) -> None:
    for case in curves.cases([studies["terms"]]):
        h = curves.numerical(case, "compliance")
        assert h is not None
        gap = -truncated_compliance.from_mean_plane(h, float(case["total_amplitude"]))
        assert np.all(np.diff(gap) < 0)
        assert np.all(gap > -1e-9)  # the surfaces do not overlap
        assert gap[0] < case["total_amplitude"]  # nor do they touch before the highest crest does


def test_profiles_show_the_heights_of_the_data(studies: dict[str, xr.Dataset]) -> None:
    (axes,) = sketch("profiles", [studies["one"]]).axes
    x, z = axes.get_lines()[0].get_data()
    assert x[0] == 0
    assert x[-1] == 2
    # The series of the scene, written out: gamma = 5/2, D = 1.5, phases 0 and 1.
    exact = np.cos(2 * np.pi * np.asarray(x)) + 2.5**-0.5 * np.cos(5 * np.pi * np.asarray(x) + 1)
    np.testing.assert_allclose(z, exact, atol=1e-13)


def test_methods_differ_without_colour() -> None:
    estimates = [style.line(method) for method in (*curves.ESTIMATES, "westergaard")]
    assert len({line["color"] for line in estimates}) == len({str(line["linestyle"]) for line in estimates}) == 4
    grey = [np.dot(look["color"][:3], [0.299, 0.587, 0.114]) for look in style.family(8)]
    assert np.all(np.diff(grey) < -0.03)


def test_legend_of_the_contact_tree_stands_between_its_panels(studies: dict[str, xr.Dataset]) -> None:
    figure = sketch("contact_tree", [studies["one"]])
    (legend,) = (found for axes in figure.axes if (found := axes.get_legend()))
    assert [text.get_text() for text in legend.get_texts()] == ["contact"]
    top, tree = (axes.get_window_extent() for axes in figure.axes)
    assert tree.y1 <= legend.get_window_extent().y0 + 1e-6
    assert legend.get_window_extent().y1 <= top.y0
