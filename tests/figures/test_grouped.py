"""Figures by the parameters that a scene names: colours, panels and medians say what the scene asks."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from weier.data import dataset
from weier.figures import compliance, resistance
from weier.scene import Grouping

LOADS = np.geomspace(0.01, 4, 12)
GAMMAS, SEEDS, METHODS = (2.0, 2.5, 5.0), 4, ["demelio", "bem"]


@pytest.fixture(scope="module")
def sweep() -> xr.Dataset:
    """Curves that rise with gamma, and differ a little between seeds."""
    data = dataset.blank(len(GAMMAS) * SEEDS, METHODS, LOADS, 3)
    for row, (gamma, seed) in enumerate((gamma, seed) for gamma in GAMMAS for seed in range(SEEDS)):
        data["key"].values[row] = f"case{row}"
        data["D"].values[row], data["gamma"].values[row], data["m"].values[row] = 1.25, gamma, 3
        data["phases"].values[row] = 0, seed + 0.1, seed + 0.2
        data["total_amplitude"].values[row] = total = gamma + 0.1 * seed
        data["compliance"].values[row] = total * -np.expm1(-LOADS)
        data["resistance"].values[row] = total * np.exp(-LOADS)
    return data


def sketch(sweep: xr.Dataset, **grouping) -> Figure:
    figure = compliance.draw([sweep], "", Grouping(**grouping))
    figure.draw_without_rendering()
    return figure


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_a_scene_answers_its_question(sweep: xr.Dataset) -> None:
    """One panel a method, one line a ratio: its median over the seeds, in a band that holds all of them."""
    figure = sketch(sweep, colour="gamma", facet="method", median_over=("seed",))
    assert [axes.get_title() for axes in figure.axes] == [
        "(a)  Demelio,  $D=1.25$,  $m=3$",
        "(b)  boundary elements,  $D=1.25$,  $m=3$",
    ]
    for axes in figure.axes:
        ends = [line.get_ydata()[-1] for line in axes.get_lines()]
        assert ends == pytest.approx([(gamma + 0.15) * -np.expm1(-LOADS[-1]) for gamma in GAMMAS])
        assert len(axes.collections) == len(GAMMAS)
        assert len({line.get_color() for line in axes.get_lines()}) == len(GAMMAS)
    assert words(figure) == [
        *(r"$\gamma=2$", r"$\gamma=5/2$", r"$\gamma=5$"), "line: median over seed", "band: all of them",
    ]  # fmt: skip


def test_the_legend_says_what_dashes_mean_where_they_are_methods(sweep: xr.Dataset) -> None:
    figure = sketch(sweep, colour="gamma", median_over=("seed",))
    assert words(figure)[3:5] == ["Demelio", "boundary elements"]
    (axes,) = figure.axes
    assert len(axes.get_lines()) == len(GAMMAS) * len(METHODS)


def test_what_is_not_named_stays_apart(sweep: xr.Dataset) -> None:
    (axes,) = sketch(sweep.isel(solution_method=[0]), colour="gamma").axes
    assert len(axes.get_lines()) == len(GAMMAS) * SEEDS
    assert not axes.collections


@pytest.mark.parametrize("name", ["phase", "phases", "seed"])
def test_a_median_over_phases_is_one_by_each_of_their_names(name: str, sweep: xr.Dataset) -> None:
    (axes,) = sketch(sweep.isel(solution_method=[0]), colour="gamma", median_over=(name,)).axes
    assert len(axes.get_lines()) == len(axes.collections) == len(GAMMAS)


def test_a_figure_that_names_no_parameter_takes_medians_over_the_phases_alone(sweep: xr.Dataset) -> None:
    """A median over different ratios answers no question."""
    figure = compliance.draw([sweep.isel(solution_method=[0])], "")
    thick = [line for line in figure.axes[0].get_lines() if line.get_linewidth() > 0.5 and len(line.get_xdata())]
    ends = [(gamma + 0.15) * -np.expm1(-LOADS[-1]) for gamma in GAMMAS]
    assert [line.get_ydata()[-1] for line in thick] == pytest.approx(ends)
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert labels == ["Demelio", "thick: median over phases", "thin: a single profile"]


PARAMETERS = ["method", "D", "gamma", "m", "phase", "phases", "seed"]


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_parameter_can_be_colour_and_facet(name: str, sweep: xr.Dataset) -> None:
    small = sweep.isel(case=slice(0, 3))
    assert words(sketch(small, colour=name))
    assert sketch(small, facet=name).axes
    assert sketch(small, median_over=(name,)).axes


def test_a_seed_is_named_where_the_data_have_it(sweep: xr.Dataset) -> None:
    seeds = np.tile(np.arange(SEEDS, dtype=float), len(GAMMAS))
    named = words(sketch(sweep.assign_coords(seed=("case", seeds)), colour="seed"))
    assert named[:SEEDS] == [f"seed {number}" for number in range(SEEDS)]
    unknown = sweep.assign_coords(seed=("case", np.full(seeds.size, np.nan)))
    assert words(sketch(unknown, colour="seed"))[0] == "1. phases"


def test_resistance_is_grouped_as_well(sweep: xr.Dataset) -> None:
    figure = resistance.draw([sweep], "", Grouping("gamma", "method", ("seed",)))
    assert [axes.get_yscale() for axes in figure.axes] == ["log", "log"]
