"""Figures of compliance and resistance: colours, panels, medians and bands are those that the scene chooses."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from tests.scenes import blank
from weier import figures
from weier.figures import many_curves, tables
from weier.methods import westergaard
from weier.scene import Figure as Wanted
from weier.scene import Grouping

LOADS = np.geomspace(0.01, 4, 12)
GAMMAS, SEEDS, METHODS = (2.0, 2.5, 5.0), 4, ["demelio", "bem"]


@pytest.fixture(scope="module")
def sweep() -> xr.Dataset:
    """Curves that rise with gamma, and differ a little between seeds."""
    data = blank(len(GAMMAS) * SEEDS, METHODS, LOADS, 3)
    for row, (gamma, seed) in enumerate((gamma, seed) for gamma in GAMMAS for seed in range(SEEDS)):
        data["key"].values[row] = f"case{row}"
        data["D"].values[row], data["gamma"].values[row], data["m"].values[row] = 1.25, gamma, 3
        data["phases"].values[row] = 0, seed + 0.1, seed + 0.2
        data["tail_amplitude"].values[row] = 0.1
        data["total_amplitude"].values[row] = total = gamma + 0.1 * seed
        data["compliance"].values[row] = total * -np.expm1(-LOADS)
        data["resistance"].values[row] = total * np.exp(-LOADS)
    return data


def sketch(sweep: xr.Dataset, **grouping) -> Figure:
    return many_curves.draw([sweep], "", "compliance", grouping=Grouping(**grouping))


def words(figure: Figure) -> list[str]:
    legend = figure.legends[0] if figure.legends else figure.axes[0].get_legend()
    return [text.get_text() for text in legend.get_texts()]


def test_a_scene_answers_its_question(sweep: xr.Dataset) -> None:
    """One panel a method, one line a ratio: its median over the seeds, in a band that holds all of them."""
    figure = sketch(sweep, colour="gamma", facet=("method",), median_over=("seed",))
    assert [axes.get_title() for axes in figure.axes] == ["(a)  Demelio", "(b)  boundary elements"]
    assert figure.get_suptitle() == "$D=1.25$,  $m=3$"  # what does not vary
    for axes in figure.axes:
        ends = [line.get_ydata()[-1] for line in axes.get_lines()]
        assert ends == pytest.approx([(gamma + 0.15) * -np.expm1(-LOADS[-1]) for gamma in GAMMAS])
        assert len(axes.collections) == len(GAMMAS)
        assert len({line.get_color() for line in axes.get_lines()}) == len(GAMMAS)
    assert words(figure) == [
        r"$\gamma=2$",
        r"$\gamma=5/2$",
        r"$\gamma=5$",
        "line: median over phases",
        "band: 10 to 90 % of 4",
    ]


def test_a_figure_that_names_no_parameter_takes_medians_over_the_phases_alone(sweep: xr.Dataset) -> None:
    """A median over different ratios answers no question."""
    with pytest.raises(ValueError, match="gamma varies among the curves"):
        sketch(sweep)
    longer = xr.concat([sweep.isel(case=slice(0, SEEDS)), sweep.isel(case=slice(0, SEEDS))], "case")
    (axes,) = sketch(longer.isel(solution_method=[0])).axes
    assert axes.get_title() == r"$D=1.25$,  $\gamma=2$,  $m=3$"  # the legend names the method
    assert len(axes.get_lines()) == len(axes.collections) == 1
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["Demelio", "line: median over phases", "band: 10 to 90 % of 8"]


def test_a_median_takes_common_loads_and_a_legend_what_is_seen(sweep: xr.Dataset, monkeypatch) -> None:
    other = sweep.assign_coords(mean_pressure=2 * LOADS)
    with pytest.raises(ValueError, match="takes curves under the same loads"):
        many_curves.draw([sweep, other], "", "compliance", Grouping("gamma", median_over=("seed",)))
    with pytest.raises(ValueError, match="there is no resistance above 0 to draw"):
        many_curves.draw([sweep.assign(resistance=0 * sweep["resistance"])], "", "resistance")
    monkeypatch.setattr(many_curves.style, "MAX_GRID", 1)
    figure = sketch(sweep, colour="gamma", facet=("gamma",), median_over=("seed",))
    assert words(figure)[:2] == [r"$\gamma=2$", "Demelio"]


def test_a_scene_may_set_the_scale_of_loads(sweep) -> None:
    for scale, loads in (("log", slice(4, None)), ("linear", slice(None))):  # each other than the default
        (axes,) = figures._drawn(Wanted("compliance", x=scale), [sweep.isel(case=[0], mean_pressure=loads)]).axes
        assert axes.get_xscale() == scale
        assert (axes.get_xlim()[0] == 0) == (scale == "linear")
        axes.figure.draw_without_rendering()


def test_an_error_is_a_band_where_it_can_be_seen_and_else_it_is_left_out(sweep: xr.Dataset) -> None:
    one = sweep.isel(case=[0]).copy(deep=True)
    one["compliance_error"] = one["compliance"] * 0.1
    (axes,) = many_curves.draw([one.assign(compliance_error=one["compliance"] * 1e-4)], "", "compliance").axes
    assert not axes.collections
    (axes,) = many_curves.draw([one], "", "compliance").axes
    (band, _) = axes.collections
    values = one["compliance"].sel(solution_method="demelio").values[0]
    assert band.get_paths()[0].vertices[:, 1].max() == pytest.approx(1.1 * values.max())
    said = [text.get_text() for text in axes.get_legend().get_texts()]
    assert said[2:] == ["error stated by Demelio", "error stated by boundary elements"]


def test_an_ensemble_is_a_band_behind_the_curves_of_its_series(sweep: xr.Dataset) -> None:
    single = sweep.isel(case=[0])
    unsolved = blank(1, METHODS, LOADS, 3)  # adds nothing
    axes = many_curves.draw([single], "", "compliance", behind=[sweep, unsolved]).axes[0]
    assert not many_curves.draw([single], "", "compliance", behind=[unsolved]).axes[0].collections
    band = axes.collections[0]
    assert band.get_label() == f"10 to 90 % of {SEEDS} phases"  # those of the same gamma, by boundary elements alone
    expected = np.percentile(sweep["compliance"].values[:SEEDS, 1, -1], [10, 90])
    vertices = band.get_paths()[0].vertices
    at_end = vertices[vertices[:, 0] == LOADS[-1], 1]
    assert (at_end.min(), at_end.max()) == pytest.approx(tuple(expected))


def test_surfaces_that_differ_in_the_first_phase_alone_are_lines_of_their_own(sweep: xr.Dataset) -> None:
    """A median of the two would look like one curve; the phase of a single wave changes nothing."""
    two = sweep.isel(case=slice(0, 2)).copy(deep=True)
    two["phases"].values[:] = [[0, 1, 1], [2, 1, 1]]
    (axes,) = sketch(two.isel(solution_method=[0]), colour="phases").axes
    assert words(axes.figure) == [r"$\phi=1$", "2. phases"]
    ends = [line.get_ydata()[-1] for line in axes.get_lines()]
    assert ends == pytest.approx(two["compliance"].values[:, 0, -1].tolist())
    panels = [axes.get_title() for axes in sketch(two).axes]
    assert [title.count("phi") for title in panels] == [1, 0]
    with pytest.raises(ValueError, match="phases varies among the curves"):
        sketch(two, colour="gamma")
    two["m"].values[:], two["phases"].values[:, 1:] = 1, np.nan
    sketch(two, colour="gamma")


def test_a_curve_whose_colour_is_its_method_is_named_once(sweep: xr.Dataset) -> None:
    figure = sketch(sweep.isel(case=[0]), colour="method")
    assert [line.get_label() for line in figure.axes[0].get_lines()] == ["Demelio", "boundary elements"]


def test_medians_by_arrays_are_those_of_single_curves(sweep: xr.Dataset) -> None:
    """The lines of all cases, one by one, and their percentiles at common loads."""
    (axes,) = sketch(sweep.isel(solution_method=[1]), colour="gamma", median_over=("seed",)).axes
    own = tables.Values(sweep, "compliance")
    drawn = [own.line(row, METHODS.index("bem")) for row in range(SEEDS)]
    middle = np.median([values for _, values in drawn], axis=0)
    np.testing.assert_allclose(axes.get_lines()[0].get_xydata(), np.transpose([drawn[0][0], middle]))


def test_a_compliance_is_no_polygon():
    loads = np.array([0.01, 0.1, 0.4, 0.8, 0.944, 1.1, 2.0])
    h, fine = westergaard.compliance(loads), tables.refined_loads(loads)
    smooth = tables.smooth_compliance(loads, h, westergaard.resistance(loads))
    values, exact, inside = smooth(fine), westergaard.compliance(fine), fine < loads[4]
    polygon = np.abs(np.interp(fine, loads, h) - exact)[inside].max()
    assert np.abs(values - exact)[inside].max() < 0.1 * polygon
    assert values[:: tables.PIECES] == pytest.approx(h, abs=1e-15)
    assert tables.smooth_compliance(loads, h, np.full(loads.size, np.nan)) is None


def test_traces_of_one_name_are_told_apart() -> None:
    """By the shortest wavelength, and by the digest where it agrees; a series has no name."""
    data = blank(5, ["patches"], LOADS, 2)
    data["compliance"].values[:] = 1.0
    rows = (
        ["a/x.csv", 5e-6, "A"],
        ["a/x.csv", 1e-5, "B"],
        ["a/_$y.csv", 5e-6, "C"],
        ["a/_$y.csv", 5e-6, "D"],
        ["", np.nan, ""],
    )
    columns = dict(zip(("trace", "trace_shortest", "trace_digest"), zip(*rows, strict=True), strict=True))
    data = data.assign_coords({name: ("case", np.array(column)) for name, column in columns.items()})
    names = tables.table_of([tables.Values(data, "compliance")])["trace"].tolist()
    micro = "\u00b5m"
    assert names == [
        f"x.csv, shortest 5 {micro}",
        f"x.csv, shortest 10 {micro}",
        rf" _\$y.csv, shortest 5 {micro}, C",
        rf" _\$y.csv, shortest 5 {micro}, D",
        "",
    ]
