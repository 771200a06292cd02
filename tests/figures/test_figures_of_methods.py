"""Figures of what is measured of the methods: what is drawn can be seen, and what is seen is explained."""

import numpy as np
import xarray as xr

from weier.figures import extremes

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
            **{name: ("nodes", [1.0, 10.0]) for name in extremes.CONDITIONS},
            "D": ("case", [1.25]),
            "gamma": ("case", [5.0]),
            "m": ("case", [3.0]),
            "phases": (("case", "term"), [[0.0, 1.0, 1.0]]),
        },
        {"variant": ["archard"], "nodes": [3, 30]},
    )
    figure = extremes.draw([data], "")
    figure.draw_without_rendering()
    axes = figure.axes[0]
    place = axes.transAxes.inverted().transform(axes.transData.transform([(power, 12) for power in powers]))[:, 0]
    assert np.all(np.diff(place) > 0.02)
    assert place[powers == 2] - place[powers == -2] > 0.25  # of the axis, where all digits are lost and found
    assert [label.get_text() for label in axes.get_xticklabels()][:2] == ["$10^{-300}$", "$10^{-30}$"]
