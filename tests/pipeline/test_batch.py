"""A batch: each case with whatever its methods return."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from tests.scenes import scene_in
from weier.methods import registry
from weier.methods.registry import PLANNED, find_method
from weier.methods.solve import solve_checked
from weier.pipeline import batch, workers


def test_estimates_are_made_once_for_profiles_that_differ_in_phases_alone(tmp_path, monkeypatch):
    """And with their seconds, and no others: neither for other profiles nor with other settings."""
    solved = []

    def counted(profile, loads, method, settings):
        solved.append((method.name, profile.D, profile.m, settings.get("points")))
        return solve_checked(profile, loads, method, settings)

    monkeypatch.setattr(workers, "solve_checked", counted)
    product = "{product: {D: [1.25, 1.5], gamma: 2, m: [1, 2], seed: [1, 2, 3]}"
    loaded = scene_in(
        tmp_path,
        "{title: t, loads: [0.1, 1], methods: [layer, bem], batch: 100, studies: {one: "
        f"{product}}}, other: {product}, methods: [layer], settings: {{layer: {{points: 48}}}}}}}}}}",
    )
    data = batch.solve_batch(loaded.distinct, loaded.loads)
    layers = [(D, m, points) for name, D, m, points in solved if name == "layer"]
    assert layers == [(D, m, points) for points in (None, 48) for D in (1.25, 1.5) for m in (1, 2)]
    assert len(solved) == 8 + 12
    for number, case in enumerate(loaded.distinct):
        own = case.settings.get("layer", {})
        expected = find_method("layer").solve(case.profile, loaded.loads, **own).compliance
        np.testing.assert_array_equal(data["compliance"].values[number, 0], expected)
    assert np.all(data["seconds"].values[:, 0] > 0)


class Planned(NamedTuple):
    """What a plan may return: arrays over the loads, and what it expected as numbers."""

    compliance: np.ndarray
    resistance: np.ndarray
    planned_seconds: float
    planned_error: float


def test_what_a_plan_expected_is_stored_with_its_curves(tmp_path, monkeypatch):
    def solve(profile, loads, tolerance: float = 1e-3, quantity: str = "compliance") -> Planned:
        return Planned(loads, 1 / loads, 2.5, 1e-4 * profile.m)

    planned = replace(registry.find_method(PLANNED), solve=solve)
    monkeypatch.setattr(registry, "METHODS", (*registry.METHODS[:-1], planned))
    study = {"product": {"D": 1.5, "gamma": 3, "m": [1, 2]}}
    loaded = scene_in(tmp_path, {"title": "t", "loads": [0.1, 1], "tolerance": 0.01, "studies": {"one": study}})
    data = batch.solve_batch(loaded.studies["one"], loaded.loads)
    assert data["planned_seconds"].values.tolist() == [2.5, 2.5]
    assert data["planned_error"].values == pytest.approx([1e-4, 2e-4])
    assert data["compliance"].values[0, 0].tolist() == [0.1, 1.0]
    assert "planned_method" not in data, "what this plan does not return"
