"""Figures of what is measured of the methods: what is drawn can be seen, and what is seen is explained."""

import numpy as np
import pytest
import xarray as xr

from weier.figures import convergence, extremes

LOADS = np.geomspace(1e-3, 10, 6)
TERMS = np.array([1, 2, 4, 8])
TOTAL = 1.4


@pytest.fixture
def infinite() -> xr.Dataset:
    """Two cases: estimates of up to four terms, and bounds of up to eight that narrow fourfold from row to row."""
    h = TOTAL * -np.expm1(-LOADS) * np.ones((2, TERMS.size, 1))
    width = 0.4 / 4.0 ** np.arange(TERMS.size)[:, None]
    rows, over = ("case", "resolved_terms", "mean_pressure"), ("resolved_terms", TERMS)
    estimate, slope = h.copy(), TOTAL * np.exp(-LOADS) * np.ones_like(h)
    estimate[:, -1], slope[:, -1] = np.nan, np.nan
    data = xr.Dataset(
        {
            "compliance": (rows, estimate), "resistance": (rows, slope),
            "compliance_lower": (rows, np.maximum(h - width, 0)),
            "compliance_upper": (rows, np.minimum(h + width, TOTAL)),
            "total_amplitude": ("case", [TOTAL, TOTAL]), "tail_amplitude": ("case", [0.0, 0.0]),
            "D": ("case", [1.25, 1.25]), "gamma": ("case", [2.0, 5.0]), "m": ("case", [np.inf, np.inf]),
            "phases": (("case", "term"), np.full((2, 2), np.nan)),
        },
        {"mean_pressure": LOADS},
    )  # fmt: skip
    return data.assign_coords({"resolved_terms": over})


def test_bounds_are_seen_and_never_beyond_full_contact(infinite: xr.Dataset) -> None:
    figure = convergence.draw([infinite], "")
    figure.draw_without_rendering()
    first, second, errors = figure.axes
    for axes in (first, second):
        names = [text.get_text() for text in axes.get_legend().get_texts()]
        assert names == [*(f"bounds, $k={k}$" for k in TERMS), "estimate, $k=4$"]
        bands = [band.get_paths()[0].vertices for band in axes.collections]
        widths = [np.ptp(band[np.isclose(band[:, 0], LOADS[0]), 1]) for band in bands]  # at the first load
        assert np.all(np.diff(widths) < 0)
        assert max(band[:, 1].max() for band in bands) <= TOTAL
        assert np.ptp(axes.get_ylim()) < 1.5 * np.ptp(bands[0][:, 1])
    assert len(errors.get_lines()) == 4
    assert figure.get_figheight() < 7  # inches, where three panels took ten


def test_the_loads_of_the_extremes_are_spread_where_things_happen() -> None:
    powers = np.array([-300, -100, -30, -10, -3, -2, -1, 0, 1, 2, 3, 10, 30, 100, 300.0])
    data = xr.Dataset(
        {
            "compliance_digits": (("case", "variant", "mean_pressure"), np.full((1, 1, powers.size), 12.0)),
            "mean_pressure": (("case", "mean_pressure"), 10.0 ** powers[None]),
            "solution_method": ("variant", ["archard"]),
            **{name: ("nodes", [1.0, 10.0]) for name in extremes.CONDITIONS},
            "D": ("case", [1.25]), "gamma": ("case", [5.0]), "m": ("case", [3.0]),
            "phases": (("case", "term"), [[0.0, 1.0, 1.0]]),
        },
        {"variant": ["archard"], "nodes": [3, 30]},
    )  # fmt: skip
    figure = extremes.draw([data], "")
    figure.draw_without_rendering()
    axes = figure.axes[0]
    place = axes.transAxes.inverted().transform(axes.transData.transform([(power, 12) for power in powers]))[:, 0]
    assert np.all(np.diff(place) > 0.02)
    assert place[powers == 2] - place[powers == -2] > 0.25  # of the axis, where all digits are lost and found
    assert [label.get_text() for label in axes.get_xticklabels()][:2] == ["$10^{-300}$", "$10^{-30}$"]
