"""Estimates and bounds of the infinite series by the number of terms resolved."""

import numpy as np
import pytest

from weier import Profile, figures, random_phases
from weier.accuracy import convergence as study
from weier.accuracy.metrics import by_resolved_terms
from weier.figures import convergence as convergence_figure
from weier.methods import bem
from weier.scene import Figure

LOADS = np.geomspace(3e-3, 3, 7)
PROFILE = Profile(1.25, 2, np.inf, random_phases(2))


@pytest.fixture(scope="module")
def measured():
    return study.measure_convergence([PROFILE], LOADS, 6)


@pytest.fixture
def convergence(measured):
    return measured.isel(case=0)


def test_estimates_lie_within_all_bounds_and_close_in(convergence):
    h = convergence["compliance"].values
    low, high = convergence["compliance_lower"].values, convergence["compliance_upper"].values
    mesh = np.pi**2 / 2 / 32**2  # dx^2/8 times the curvature of one wave, on the grid of the estimate, in g_0
    assert np.all((low - mesh <= h) & (h <= high + mesh))
    # The last estimate lies within the bounds of every shorter series: they are about the same infinite one.
    assert np.all((low - mesh <= h[-1]) & (h[-1] <= high + mesh))
    deviation = np.abs(h[:-1] - h[-1]).max(axis=1)
    assert deviation[-1] < deviation[0] / 3
    # Far better than the certificate, which is half as wide as the bounds.
    assert np.all(deviation < 0.75 * (high - low)[:-1].max(axis=1) / 2)


def test_terms_that_take_too_many_points_have_a_status(monkeypatch, tmp_path):
    monkeypatch.setattr(bem.stated_errors, "MAX_POINTS", 2000)
    data = study.measure_convergence([Profile(1.25, 5, np.inf, 1.0)], LOADS[::2], 5)
    found = data.isel(case=0)
    assert np.isfinite(found["compliance"].values).all(axis=1).tolist() == [True, True, True, True, False]
    assert found["status"].values.tolist() == [0, 0, 0, 0, 2]
    low, high = (found[f"compliance_{side}"].values[:4] for side in ("lower", "upper"))
    assert np.all(low.max(axis=0) <= high.min(axis=0))
    assert np.all(high <= float(found["total_amplitude"]))
    figures.draw(Figure("convergence"), [data], tmp_path / "figure.png")


def test_the_file_counts_resolved_terms(convergence):
    assert convergence["resolved_terms"].values.tolist() == [1, 2, 3, 4, 5, 6]
    assert (np.diff(convergence["points"].values) > 0).all()
    assert "long_name" in convergence["resolved_terms"].attrs


def test_bounds_are_seen_in_the_figure_and_never_beyond_full_contact(convergence):
    bounds_of_one, _ = convergence_figure.draw([convergence.expand_dims("case")], "").axes
    names = [text.get_text() for text in bounds_of_one.get_legend().get_texts()]
    assert names == [*(f"bounds, $k={k}$" for k in (1, 2, 4, 6)), "estimate, $k=6$"]
    bands = [band.get_paths()[0].vertices for band in bounds_of_one.collections]
    widths = [np.ptp(band[np.isclose(band[:, 0], LOADS[0]), 1]) for band in bands]  # at the first load
    assert np.all(np.diff(widths) < 0)
    assert max(band[:, 1].max() for band in bands) <= PROFILE.total_amplitude
    assert np.ptp(bounds_of_one.get_ylim()) < 1.5 * np.ptp(bands[0][:, 1])


def test_the_figure_is_written_in_all_formats_and_needs_several_estimates(convergence, tmp_path):
    figures.draw(Figure("convergence"), [convergence.expand_dims("case")], tmp_path / "figure.png")
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".pdf", ".svg"}
    shortest = convergence.isel(resolved_terms=[0])
    with pytest.raises(ValueError, match="no cases with several estimates"):
        figures.draw(Figure("convergence"), [shortest.expand_dims("case")], tmp_path / "one.png")


def test_the_table_has_the_errors_of_each_number_of_terms(measured, convergence):
    text = study.table_of(measured)
    assert text.startswith("| series | resolved terms |")
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| D = 1.25, gamma = 2")]
    h, low, high = (convergence[f"compliance{part}"].values for part in ("", "_lower", "_upper"))
    nodes = convergence["points"].values
    assert [row[1:3] for row in rows] == [[str(k), f"{nodes[k - 1]:.0f}"] for k in range(1, 7)]
    widths = [float(np.max(high[k] - low[k])) / 2 for k in range(6)]
    assert [float(row[3]) for row in rows] == pytest.approx(widths, rel=0.05)
    distances = [float(np.max(np.abs(h[k] - h[5]))) for k in range(5)]
    assert [float(row[4]) for row in rows[:-1]] == pytest.approx(distances, rel=0.05)
    assert len(rows[-1]) == 4  # the error of the last estimate is not known


def test_errors_of_estimates_are_from_the_last_one(convergence):
    cut = convergence.copy(deep=True)
    cut["compliance"].values[4:] = np.nan
    width, error = by_resolved_terms(cut)
    assert np.isfinite(width).all()
    assert error[2] == np.abs(cut["compliance"].values[2] - cut["compliance"].values[3]).max()
    assert np.isfinite(error).tolist() == [True] * 3 + [False] * 3
    cut["compliance"].values[:], cut["compliance_lower"].values[:] = np.nan, np.nan
    assert np.isnan(by_resolved_terms(cut)).all()
