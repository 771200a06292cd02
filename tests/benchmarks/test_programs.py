"""The benchmark's own code, on tiny grids and without the programs it compares with; no time is asserted."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from benchmarks import measure, report, to_error
from benchmarks.problem import Problem, Reference, examine, fourier, linear_elements
from benchmarks.programs import PROGRAMS
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


def made_up(repeats: int = 2) -> xr.Dataset:
    """All programs on two sizes, with made-up numbers."""
    data = measure.blank({512: list(PROGRAMS), 2048: list(PROGRAMS)}, LOADS, repeats)
    for rank, name in enumerate(data["program"].values):
        row = data.sel({"program": name})
        for variable in ("work", "compliance", "residual", "load_error", "own_tolerance", "error"):
            row[variable].values[:] = TOLERANCE / (rank + 1)
        row["converged"].values[:] = 1
        row["seconds"].values[:] = 0.1 * (rank + 1)
    return data.assign_attrs(
        D=1.25,
        gamma="5",
        m=1,
        tolerance=TOLERANCE,
        reference_method="patches",
        reference_seconds=0.05,
        packages="numpy 2",
        machine="a computer",
        discretisation="Made up.",
    )


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


def test_the_table_holds_ratios_and_counts_wrong_solutions():
    data = made_up()
    data["residual"].loc[{"program": "tamaas", "points": 512}] = 1e-3
    data["converged"].loc[{"program": "contact_mechanics", "points": 512, "mean_pressure": LOADS[0]}] = 0
    lines = {
        tuple(cell.strip() for cell in line.split("|")[1:3]): line for line in report.table(data).splitlines()[9:]
    }
    assert "| 3 |" in lines["512", "tamaas"]
    assert "4 reported as converged" in lines["512", "tamaas"]
    assert "1 not converged" in lines["512", "ContactMechanics"]
    assert lines["2048", "tamaas"].endswith("| 0 |")


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


def test_contact_patches_take_the_target_as_their_tolerance(one_wave, monkeypatch):
    tolerances = []
    monkeypatch.setattr(to_error, "MIN_SECONDS", 0.0)
    monkeypatch.setattr(to_error, "REPEATS", 1)
    monkeypatch.setattr(to_error.patches, "curve", lambda *arguments: tolerances.append(arguments[-1]))
    reached = to_error.measure(to_error.PATCHES, one_wave)
    assert [one.points for one in reached] == [0] * len(to_error.TARGETS)
    assert tolerances == list(to_error.TARGETS)


def test_the_smallest_grid_is_found(monkeypatch, capsys):
    tried = []

    def second_order(name, points, residual, reference):
        tried.append(points)
        return to_error.Attempt((points / 100) ** -2.0, lambda: lambda: 1.0)

    monkeypatch.setattr(to_error, "attempt", second_order)
    reached = to_error.find_smallest("weier", 1e-4, None)
    assert reached == to_error.Reached(next(size for size in to_error.SIZES if size >= 10_000), 1.0)
    assert 1 < len(tried) < len(to_error.SIZES) / 2
    assert to_error.find_smallest("weier", 1e-7, None) is None
    assert "1e-07 g_0 by weier: 196608 nodes leave" in capsys.readouterr().err


def test_the_table_of_times_compares_with_the_faster_of_the_two_methods():
    reached = {
        to_error.ELEMENTS: [to_error.Reached(512, seconds) for seconds in (0.01, 0.02, 0.05, 1.0)],
        to_error.PATCHES: [to_error.Reached(0, 0.1)] * 4,
        "tamaas": [to_error.Reached(512, 1.0)] * 3 + [to_error.Reached(8192, np.inf)],
        "slippy": [to_error.Reached(512, 1.0)] * 3 + [None],
    }
    *_, elements, patches, tamaas, slippy = to_error.table(reached).splitlines()
    assert elements.startswith("| weier, boundary elements | 0.01 s, 512 nodes | 0.02 s, 512 nodes |")
    assert patches.startswith("| weier, contact patches | 0.1 s | 0.1 s |")
    assert tamaas.startswith("| tamaas | 1 s, 512 nodes, 100 times | 1 s, 512 nodes, 50 times |")
    assert tamaas.endswith("| over 60 s, over 600 times |")
    assert slippy.endswith("| not reached |")
    assert all(name in to_error.describe(reached) for name in ("to_error.png", tamaas))


def test_nothing_is_solved_where_no_pressure_is():
    problem = Problem(PROFILE, LOADS, 32, TOLERANCE)
    for pressure in (np.zeros(32), np.full(32, np.nan)):
        found = examine(problem, problem.height, linear_elements(32, 1.0), 0.1, pressure)
        assert np.isnan(found.compliance)
        assert found.residual == np.inf
