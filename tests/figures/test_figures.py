"""Figures: the same data give the same bytes, and studies that lack some curves can be drawn, too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from tests.scenes import blank, scene_in, solve_scene
from weier import figures, scene
from weier.data import curves
from weier.data.variables import Status
from weier.figures import truncation
from weier.pipeline.gather import read_study

SCENE = """
title: Small
loads: [0.01, 0.3, 1.5]
methods: [archard, demelio, bem, patches]
settings: {bem: {points_per_wave: 16}}
contact_edges: true
studies:
  terms:
    product: {D: 1.25, gamma: 3, m: [1, 2], phases: 1.0}
  one:
    product: {D: 1.5, gamma: "5/2", m: 2, phases: 1.0}
"""
FORMATS = ("pdf", "svg", "png")
KINDS = [*figures.KINDS]


@pytest.fixture(scope="module")
def studies(tmp_path_factory: pytest.TempPathFactory) -> dict[str, xr.Dataset]:
    folder = tmp_path_factory.mktemp("scene")
    loaded = scene_in(folder, SCENE)
    solutions = solve_scene(loaded, folder / "curves")
    return {name: read_study(solutions, name) for name in loaded.studies}


def many_cases(methods: tuple[str, ...] = ("archard", "patches", "new")) -> xr.Dataset:
    """Smooth curves of more cases than have panels: m up to 8 and infinite, the first of them without archard."""
    loads = np.geomspace(0.01, 10, 7)
    data = blank(9, methods, loads, 8, edges=4)
    data["contact_edge"].values[3, :-1, :2] = 0.1, 1.2  # over the end of the period; the last load is full contact
    for case, m in enumerate([1, 2, 3, 4, 5, 6, 7, 8, np.inf]):
        data["key"].values[case] = f"case{case}"
        data["D"].values[case], data["gamma"].values[case], data["m"].values[case] = 1.5, 2, m
        data["total_amplitude"].values[case], data["tail_amplitude"].values[case] = 1 + 0.1 * case, 0.1
        data["phases"].values[case, : int(min(m, 8))] = 0.5
        for row in range(case == 0, 3):
            data["compliance"].values[case, row] = (1 + 0.1 * case) * -np.expm1(-loads * (1 + row))
            data["resistance"].values[case, row] = np.exp(-loads * (1 + row))
            data["contact_fraction"].values[case, row] = -np.expm1(-loads * (1 + row))
            data["status"].values[case, row] = Status.solved
    return data


def file_bytes(kind: str, given: list[xr.Dataset], folder: Path, formats: tuple[str, ...] = FORMATS) -> list[bytes]:
    figures.draw(scene.Figure(kind, title="A title"), given, folder / "figure.pdf", formats)
    return [(folder / f"figure.{suffix}").read_bytes() for suffix in formats]


def sketch(kind: str, given: list[xr.Dataset]) -> Figure:
    """A figure that is not saved."""
    return figures._drawn(scene.Figure(kind), given)


@pytest.mark.parametrize("kind", ["compliance", "message"])
def test_a_figure_shows_nothing_of_the_variables_that_are_not_read_for_it(
    kind: str, studies: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    """An SVG has every line and word of a figure."""
    (first,) = file_bytes(kind, [studies["one"]], tmp_path, ("svg",))
    shown = studies["one"].drop_vars(figures.undrawn(kind), errors="ignore")
    assert [first] == file_bytes(kind, [shown], tmp_path, ("svg",))


def test_same_data_same_bytes_in_each_format(studies: dict[str, xr.Dataset], tmp_path: Path) -> None:
    pdf, svg, png = first = file_bytes("compliance", [studies["one"]], tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["figure.pdf", "figure.png", "figure.svg"]
    assert first == file_bytes("compliance", [studies["one"]], tmp_path)
    assert pdf.startswith(b"%PDF")
    assert b"<svg" in svg
    assert png.startswith(b"\x89PNG")
    assert b"CreationDate" not in pdf
    assert b"dc:date" not in svg


@pytest.mark.parametrize("kind", KINDS)
def test_many_cases_that_lack_curves_are_drawn_unless_nothing_tells_them_apart(kind: str) -> None:
    if figures.KINDS[kind].grouped:
        with pytest.raises(ValueError, match="m varies among the curves and nothing shows it"):
            sketch(kind, [many_cases()])
    else:
        sketch(kind, [many_cases()])


@pytest.mark.parametrize("more", [{}, {"returned": ["mean_gap"]}], ids=["of solutions", "of estimates"])
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in ("borodich_galanov", "profiles")])
def test_a_figure_without_curves_is_refused_and_leaves_no_file(
    kind: str, more: dict[str, list[str]], tmp_path: Path
) -> None:
    empty = blank(2, ["archard", "bem"], np.array([0.1, 1.0]), 2, **more)
    with pytest.raises(ValueError, match="there are no "):
        figures.draw(scene.Figure(kind), [empty], tmp_path / "figure.pdf")
    assert not list(tmp_path.iterdir())


def test_exact_method_is_the_line_and_the_other_points(studies: dict[str, xr.Dataset]) -> None:
    both = studies["one"]
    assert curves.numerical_method(both.isel(case=0)) == "patches"
    assert curves.numerical_method(both.isel(case=0, solution_method=slice(-1))) == "bem"
    (axes,) = sketch("compliance", [both]).axes
    styles = {line.get_label(): line.get_linestyle() for line in axes.get_lines()}
    assert styles["contact patches"] == "-"
    assert styles["boundary elements"] == "None"


def test_truncated_series_share_the_mean_plane_of_the_infinite_one(studies: dict[str, xr.Dataset]) -> None:
    for case in curves.cases([studies["terms"]]):
        h = curves.curve(case, "compliance", curves.numerical_method(case))
        assert h is not None
        whole = 1 / (1 - 3**-0.75)  # G for D = 1.25, gamma = 3 (22)
        gap = whole - (h + truncation.datum(case, "compliance"))
        assert np.all(np.diff(gap) < 0)
        assert np.all(gap > -1e-9)  # the surfaces do not overlap
        assert gap[0] < case["total_amplitude"]  # they touch no earlier than the highest crest does
    (axes, *_) = sketch("truncated_compliance", [studies["terms"]]).axes
    assert axes.get_ylabel().startswith("compliance $(h+G_m)/g_0$")  # not h/g_0, which has another zero
    assert axes.get_ylim()[0] == 0


def test_profiles_show_the_heights_of_the_data(studies: dict[str, xr.Dataset]) -> None:
    (axes,) = sketch("profiles", [studies["one"]]).axes
    x, z = axes.get_lines()[0].get_data()
    assert x[0] == 0
    assert x[-1] == 2
    # The series of the scene, written out: gamma = 5/2, D = 1.5, phases 0 and 1.
    exact = np.cos(2 * np.pi * np.asarray(x)) + 2.5**-0.5 * np.cos(5 * np.pi * np.asarray(x) + 1)
    np.testing.assert_allclose(z, exact, atol=1e-13)


def test_a_contact_across_the_end_of_the_period_is_drawn_at_both_ends() -> None:
    _, tree = sketch("contact_tree", [many_cases().isel(case=[3])]).axes
    ends = {(path.vertices[:, 0].min(), path.vertices[:, 0].max()) for path in tree.collections[0].get_paths()}
    assert ends == {(0.1, 1.2), (0.1 - 1, 1.2 - 1), (0, 1)}  # the last one in full contact
