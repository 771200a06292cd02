"""Figures of what is measured of the methods: what is drawn can be seen, and what is seen is explained."""

import numpy as np
import xarray as xr
from matplotlib.colors import to_rgb

from weier.figures import extremes, work_precision
from weier.methods.curve import QUANTITIES

LOADS = np.geomspace(1e-3, 10, 6)
TERMS = np.array([1, 2, 4, 8])
TOTAL = 1.4


def test_the_loads_of_the_extremes_are_spread_where_things_happen() -> None:
    powers = np.array([-300, -100, -30, -10, -3, -2, -1, 0, 1, 2, 3, 10, 30, 100, 300.0])
    data = xr.Dataset(
        {
            "compliance_digits": (("case", "variant", "mean_pressure"), np.full((1, 1, powers.size), 12.0)),
            "mean_pressure": (("case", "mean_pressure"), 10.0 ** powers[None]),
            "solution_method": ("variant", ["archard"]),
            "D": ("case", [1.25]),
            "gamma": ("case", [5.0]),
            "m": ("case", [3.0]),
            "phases": (("case", "term"), [[0.0, 1.0, 1.0]]),
        },
        {"variant": ["archard"]},
    )
    figure = extremes.draw([data], "")
    figure.draw_without_rendering()
    axes = figure.axes[0]
    place = axes.transAxes.inverted().transform(axes.transData.transform([(power, 12) for power in powers]))[:, 0]
    assert np.all(np.diff(place) > 0.02)
    assert place[powers == 2] - place[powers == -2] > 0.25  # of the axis, where all digits are lost and found
    assert [label.get_text() for label in axes.get_xticklabels()][:2] == ["$10^{-300}$", "$10^{-30}$"]


def trade() -> xr.Dataset:
    """Two profiles of two waves, and one of three, by a closed form, and by two methods with a tolerance."""
    settings = ["{}", '{"points_per_wave": 24, "staircase": "kept"}', '{"tolerance": 0.1}', '{"tolerance": 0.001}']
    settings += ['{"tolerance": 0.1}', '{"tolerance": 1e-06}']
    seconds = np.array([[1, 5, 10, 50, 40, 60], [3, 5, 30, 150, 120, 180], [1, 5, 10, np.nan, 20, 30]]) * 1e-3
    h = np.array([[0.2, 2e-2, 1e-2, 1e-4, 1e-4, 1e-12], [0.3, 3e-2, 2e-2, 2e-4, 2e-4, 0], [0.2, 1, 1, np.nan, 0, 0]])
    over_loads = np.stack([h, h / 2], axis=-1)
    stated = np.where(np.arange(6)[:, None] > 0, 2 * over_loads, np.nan)
    dims = "case", "variant", "mean_pressure"
    return xr.Dataset(
        {
            "seconds": (dims[:2], seconds),
            "settings": (dims[:2], np.array([settings] * 3, object)),
            **{f"{name}_deviation": (dims, over_loads) for name in QUANTITIES},
            **{f"{name}_error": (dims, stated) for name in QUANTITIES},
            "reference_resistance": (("case", "mean_pressure"), np.full((3, 2), 0.5)),
            "solution_method": ("variant", ["demelio", "bem", "bem", "bem", "patches", "patches"]),
            "D": ("case", [1.25, 1.5, 1.5]),
            "gamma": ("case", [5.0, 5.0, 3.0]),
            "m": ("case", [2.0, 2.0, 3.0]),
            "phases": (("case", "term"), [[0.0, 1.0, np.nan], [0.0, 1.0, np.nan], [0.0, 1.0, 1.0]]),
        },
        {"mean_pressure": [0.1, 1.0]},
    )


def test_the_dial_has_a_column_for_each_series() -> None:
    figure = work_precision.draw([trade()], "")
    figure.draw_without_rendering()
    assert len(figure.axes) == 4
    assert [axes.get_title() for axes in figure.axes[:2]] == [r"$\gamma=5$,  $m=2$", r"$\gamma=3$,  $m=3$"]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        *("Demelio", "boundary elements", "contact patches"),
        *("error", "stated error"),
    ]


def test_a_line_joins_the_settings_of_one_kind_that_all_profiles_have() -> None:
    """Milliseconds a load are the mean over the profiles, errors the largest; what is 0 stands at the end."""
    axes = work_precision.draw([trade()], "").axes
    two_waves = [line.get_xydata() for line in axes[0].get_lines()]  # what is stated, and then the error, by method
    assert [line.shape[0] for line in two_waves] == [1, 1, 2, 2, 2, 2]
    np.testing.assert_allclose(two_waves[3], [[10, 2e-2], [50, 2e-4]])
    np.testing.assert_allclose(two_waves[2][:, 1], [4e-2, 4e-4])
    assert np.isnan(two_waves[0][:, 1]).all()
    three_waves = [line.get_xydata() for line in axes[1].get_lines()]
    assert three_waves[3].tolist() == [[5, 1]]
    assert three_waves[5][:, 1].tolist() == [work_precision.FLOOR] * 2


def test_the_background_has_the_colour_of_the_fastest_method() -> None:
    (axes, *_) = work_precision.draw([trade()], "").axes
    bands = [(band.get_facecolor()[:3], band.get_y(), band.get_y() + band.get_height()) for band in axes.patches]
    colors = [line.get_color() for line in axes.get_lines()[::2]]  # Demelio, boundary elements, contact patches
    ends = [work_precision.CEILING, 0.3, 2e-2, 1e-12]
    assert [color for color, *_ in bands] == [to_rgb(color) for color in colors]
    np.testing.assert_allclose([high for *_, high in bands], ends[:-1])
    np.testing.assert_allclose([low for _, low, _ in bands], ends[1:])
