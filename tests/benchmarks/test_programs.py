"""The benchmark's own code, on tiny grids and without the programs it compares with; no time is asserted."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from benchmarks import measure, to_error
from benchmarks.problem import Problem, Reference, examine, fourier, linear_elements
from weier import Profile
from weier.methods import westergaard

PROFILE = Profile(1.25, 5, 1)
LOADS = np.geomspace(0.05, 1.5, 4)
REFERENCE = Reference(westergaard.compliance(LOADS), {"method": "westergaard"})
TOLERANCE = 1e-8


@pytest.fixture(scope="module")
def compared() -> xr.Dataset:
    """The fast and the dense solver, the latter on the coarser grid alone."""
    plan = {32: ["weier", "weier_default", "dense"], 64: ["weier", "weier_default"]}
    return measure.compare(PROFILE, LOADS, plan, TOLERANCE, 2, REFERENCE, lambda text: None)


def test_the_dense_inversion_solves_the_same_system(compared):
    coarse = compared.sel(points=32)
    weier, dense = (coarse["compliance"].sel(program=name) for name in ("weier", "dense"))
    assert weier.values == pytest.approx(dense.values, abs=10 * TOLERANCE)
    assert compared["residual"].max() <= TOLERANCE
    assert compared["load_error"].max() <= 1e-12
    coarse_error, fine_error = compared["error"].sel(program="weier").values
    assert fine_error < coarse_error < 5e-3
    assert np.all(compared["error"].sel(program="weier_default") < 0.2 * compared["error"].sel(program="weier"))
    assert np.isnan(compared["seconds"].sel(program="dense", points=64)).all()
    assert np.all(measure.wrong(compared) == 0)
    assert np.all(measure.failed(compared) == 0)


def test_a_wrong_solution_is_found():
    """Full contact is exact in both discretisations; a shifted, a scaled and a tensile pressure are not."""
    problem = Problem(PROFILE, np.array([2.0]), 64, TOLERANCE)
    for operator in (linear_elements, fourier):
        eigenvalue = operator(64, 1.0)
        inverse = np.concatenate([[0.0], 1 / eigenvalue[1:]])
        pressure = 2.0 + np.fft.irfft(inverse * np.fft.rfft(problem.height), 64)
        right = examine(problem, problem.height, eigenvalue, 2.0, pressure)
        assert right.compliance == pytest.approx(1.0, abs=1e-12)
        assert max(right.residual, right.load_error) <= 1e-12
        assert examine(problem, problem.height, eigenvalue, 2.0, np.roll(pressure, 1)).residual > 1e-2
        assert examine(problem, problem.height, eigenvalue, 2.0, 1.1 * pressure).load_error == pytest.approx(0.1)
        assert examine(problem, problem.height, eigenvalue, 2.0, pressure - 1.5).residual > 1e-3


@pytest.fixture
def one_wave(monkeypatch: pytest.MonkeyPatch) -> to_error.Reference:
    """Westergaard's curve in the place of the three waves."""
    monkeypatch.setattr(to_error, "PROFILE", PROFILE)
    monkeypatch.setattr(to_error, "LOADS", LOADS)
    return to_error.Reference(westergaard.compliance(LOADS), westergaard.resistance(LOADS))


@pytest.mark.parametrize(("name", "error"), [("dense", 2e-3), ("weier", 2e-3), ("weier_default", 1e-4)])
def test_the_error_on_a_grid_falls_with_the_second_power_of_the_nodes(
    name: str, error: float, one_wave: to_error.Reference
):
    """The dense inversion stands for programs that are not weier's."""
    coarse, fine = (to_error.attempt(name, points, 1e-10, one_wave) for points in (64, 256))
    assert fine.error < coarse.error / 8 < error / 8
    assert coarse.prepare()() > 0
