"""A batch: each case with whatever its methods return."""

from __future__ import annotations

from dataclasses import replace
from functools import wraps

import numpy as np
import pytest

from tests.scenes import scene_in
from weier.api import batch
from weier.api.interface import Interface
from weier.methods import registry
from weier.methods.registry import find_method
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile


def test_estimates_are_made_once_for_profiles_that_differ_in_phases_alone(tmp_path, monkeypatch):
    """And with their seconds, and no others: neither for other profiles nor with other settings."""
    solved = []

    def counting(method):
        def counted(profile, loads, **settings):
            solved.append((method.name, profile.D, profile.m, settings.get("points")))
            return method.solve(profile, loads, **settings)

        return replace(method, solve=wraps(method.solve)(counted))

    monkeypatch.setattr(registry, "METHODS", tuple(map(counting, registry.METHODS)))
    product = "{product: {D: [1.25, 1.5], gamma: 2, m: [1, 2], seed: [1, 2, 3]}"
    loaded = scene_in(
        tmp_path,
        "{title: t, loads: [0.1, 1], methods: [layer, bem], studies: {one: "
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


def test_rms_slope_and_height_are_those_of_each_surface_in_si_units():
    x = np.arange(200) / 200
    trace = Trace(1e-6 * np.cos(2 * np.pi * x) + 2e-7 * np.cos(10 * np.pi * x + 1), 1e-3, ends="periodic", unit="m")
    bodies = {"E_1": 210e9, "nu_1": 0.3, "E_2": 120e9, "nu_2": 0.34}
    found = Interface(**bodies, rho_1=1.4e-7, rho_2=1.7e-8, lambda_0=1e-3, g_0=1e-6).solve(
        [trace, Profile(1.5, 3, 2, 1.0)], [1e7, 1e8, 5e8], ["patches"]
    )
    slope = np.sqrt((1e-6 * 2 * np.pi / 1e-3) ** 2 + (2e-7 * 10 * np.pi / 1e-3) ** 2) / np.sqrt(2)
    assert (found.rms_slope[0], found.rms_height[0]) == (pytest.approx(slope), pytest.approx(7.2111e-7, rel=1e-4))
    assert (found.rms_slope.units, found.rms_curvature.units) == ("1", "m^-1")


def test_the_choice_is_stored_with_its_curves(tmp_path):
    study = {"product": {"D": 1.25, "gamma": 5, "m": [2, "inf"]}}
    loaded = scene_in(tmp_path, {"title": "t", "loads": [0.1, 1], "tolerance": 0.1, "studies": {"one": study}})
    data = batch.solve_batch(loaded.studies["one"], loaded.loads)
    assert data["solution_method"].values.tolist() == ["auto"]
    assert data["chosen_method"].values.tolist() == ["bem", "patches"]  # terms of the second are left out
    assert data["chosen_terms"].values.tolist() == [2, 3]
    assert np.all(data["compliance_error"].values <= 0.1)
