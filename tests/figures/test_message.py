"""The figure of the message: medians, bands and bounds are those of the data."""

import numpy as np
import pytest

from tests.scenes import blank
from weier.figures import message
from weier.methods import cascade, persson

LOADS = np.array([0.01, 0.02, 0.1, 1.0])
SEEDS, TERMS = 5, (1, 2, 3)


@pytest.fixture
def study():
    """Areas that halve with each term and resistances that differ between seeds."""
    cases = [(m, seed) for m in TERMS for seed in range(SEEDS)]
    data = blank(len(cases), ["persson", "patches"], LOADS, 3)
    for row, (m, seed) in enumerate(cases):
        data["D"].values[row], data["gamma"].values[row], data["m"].values[row] = 1.25, 5, m
        data["compliance"].values[row] = 1.0
        data["contact_fraction"].values[row, 1] = 0.1 * (1 + seed) * 0.5**m * LOADS
        data["resistance"].values[row, 1] = 3 + seed
        data["resistance_lower"].values[row, 1], data["resistance_upper"].values[row, 1] = 2, 9
    return data


def test_lines_bands_and_bars_are_medians_percentiles_and_bounds(study):
    area, resistance = message.draw([study], "").axes
    lines = {line.get_label(): line.get_ydata() for line in area.get_lines()}
    for load in message.STYLES:
        np.testing.assert_allclose(lines[f"p = {load:g}, median"], [0.3 * 0.5**m * load for m in TERMS])
        for theory, name in ((persson, "Persson"), (cascade, "theory of 2000")):
            expected = [float(theory.contact_fraction(load, 1.25, 5, m)) for m in TERMS]
            np.testing.assert_allclose(lines[f"p = {load:g}, {name}"], expected)
    assert not [line for line in resistance.get_lines() if "2000" in line.get_label()]  # it has no resistance
    band = resistance.collections[0].get_paths()[0].vertices
    assert (band[:, 1].min(), band[:, 1].max()) == pytest.approx((3.4, 6.6))
    bars = resistance.containers[0].lines[2][0].get_segments()[0]
    assert bars[:, 1].tolist() == [2, 9]
    assert [text.get_text() for text in area.figure.legends[0].get_texts()][3] == "10 to 90 % of 5 phases"


def test_a_load_that_was_not_solved_is_not_drawn(study):
    figure = message.draw([study.assign_coords(mean_pressure=[0.01, 0.02, 0.3, 0.9])], "")
    assert {line.get_label()[:8] for line in figure.axes[0].get_lines()} == {"p = 0.01"}
    assert "0.1" not in figure.legends[0].get_texts()[1].get_text()
    with pytest.raises(ValueError, match="no numerical curves at loads"):
        message.draw([study.assign_coords(mean_pressure=2 * LOADS)], "")
