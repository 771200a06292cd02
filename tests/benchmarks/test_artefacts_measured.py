"""Limits of the checks of measured heights: each has room on both sides."""

import pytest

from benchmarks import artefacts
from weier.surface import bends, spectrum
from weier.surface.measured import artefacts as checks


def test_roughness_is_taken_and_artefacts_are_recognised():
    refused, missed = artefacts.wrong(2)
    assert refused == 0
    assert missed <= 4  # zeros among heights about zero, on rough lines


@pytest.mark.parametrize(
    ("limit", "factor", "side"),
    [("SENTINEL_DEVIATIONS", 0.1, 0), ("MIN_DISTINCT", 1.2, 1), ("JUMP_OUTLIER", 0.25, 0), ("JUMP_OUTLIER", 20.0, 1)],
)
def test_limits_beyond_their_room_are_seen(limit, factor, side):
    usual, before = artefacts.wrong(1), getattr(checks, limit)
    with artefacts.scaled(limit, factor):
        assert artefacts.wrong(1)[side] > usual[side]
    assert getattr(checks, limit) == before


def test_fits_to_roughness_are_seldom_doubted(monkeypatch):
    doubted, fits = artefacts.doubted_fits(1)
    assert doubted == 0
    assert fits > 10
    monkeypatch.setattr(spectrum, "DOMINANCE_DEVIATIONS", 0.5)
    assert artefacts.doubted_fits(1)[0] > 5


def test_fits_to_power_laws_are_seldom_cut_off(monkeypatch):
    bent, fits = artefacts.bent_laws(3)
    assert bent <= 0.15 * fits
    assert fits > 10
    monkeypatch.setattr(bends, "RARE_BEND_MARGIN", -3.0)
    assert artefacts.bent_laws(3)[0] > 0.3 * fits
