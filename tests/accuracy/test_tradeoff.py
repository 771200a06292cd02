"""The measured trade: errors against the exact contact, who takes part, what is written."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tests.trade import small_trade
from weier import Profile, figures
from weier.accuracy import tradeoff
from weier.accuracy.metrics import MEASURED, STATED, seconds_per_load, worst_over_loads
from weier.data import dataset
from weier.data.variables import Status
from weier.methods import bem, registry
from weier.methods.curve import QUANTITIES
from weier.methods.errors import ConvergenceError
from weier.methods.registry import find_method
from weier.methods.settings import check_names
from weier.scene import Figure

ROUNDING = 1e-15  # g_0: of heights of the order of 1


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    return small_trade(tmp_path_factory.mktemp("scene"))


def error(measured, name, case=1, quantity="compliance", kind=MEASURED):
    return worst_over_loads(measured, quantity, kind)[case, measured["variant"].values.tolist().index(name)]


@pytest.mark.parametrize("name", ["bem", "patches"])
def test_errors_and_what_is_stated_of_them_are_within_the_tolerance(measured, name):
    variants = [variant for variant in measured["variant"].values.tolist() if re.fullmatch(f"{name} 1e.*", variant)]
    run = [variant for variant in variants if np.isfinite(error(measured, variant))]
    assert len(run) >= {"bem": 4, "patches": 11}[name]  # a grid of 800 points is the finest here
    for variant in run:
        assert error(measured, variant, kind=STATED) <= float(variant.split()[1])
        for quantity in QUANTITIES:
            assert error(measured, variant, quantity=quantity) <= error(measured, variant, 1, quantity, STATED)
    # Contact patches are at rounding at any tolerance, since their moves square the error.
    assert error(measured, run[-1]) < max(1e-2 * error(measured, run[0]), ROUNDING)


def test_methods_that_state_no_error_have_none(measured):
    """Nor is an estimate as accurate as the grid of the paper, with its staircase."""
    for name in ("archard", "demelio", "layer 24"):
        assert np.isnan(error(measured, name, kind=STATED))
        assert error(measured, name) > 10 * error(measured, "bem kept 12")


def test_contact_patches_have_an_error_of_their_own(measured):
    """The reference is of the same profile shifted along x: no variant is right by construction."""
    assert 0 < error(measured, "patches 1e-11") < 1e-11
    assert error(measured, "patches 1e-11", quantity="resistance") < 1e-11
    # One wave is Westergaard's in closed form.
    assert error(measured, "archard", case=0) < 1e-13
    assert error(measured, "patches 1e-11", case=0) < 1e-13


def test_a_grid_too_fine_for_a_profile_is_left_out(measured):
    run = np.isfinite(seconds_per_load(measured))
    names = measured["variant"].values.tolist()
    assert run[:, names.index("bem 1e-05")].tolist() == [True, False]
    assert run[:, names.index("bem 1e-04")].all()
    assert np.isnan(error(measured, "bem 1e-05"))


def test_every_variant_is_a_method_with_its_settings():
    for variant in tradeoff.variants(Profile(1.25, 5, 2)):
        check_names(find_method(variant.method), variant.settings)
        assert len(variant.name) <= 16


def test_an_infinite_series_is_refused():
    with pytest.raises(ValueError, match=r"m must be finite .* leave the case out"):
        tradeoff.variants(Profile(1.25, 5, np.inf))


def test_the_table_and_the_figure_are_made_from_the_file(measured, tmp_path):
    dataset.write(measured, tmp_path / "tradeoff.nc", "Small")
    again = dataset.read(tmp_path / "tradeoff.nc")
    assert again["seconds"].values == pytest.approx(measured["seconds"].values, nan_ok=True)
    assert again["phases"].values[1, 1] == 1.0
    text = tradeoff.table_of(again)
    assert text.startswith("| method and setting |")
    assert text.count("\n| bem ") == sum(method == "bem" for method in measured["solution_method"].values)
    figures.draw(Figure("work_precision"), [again], tmp_path / "figure.png")
    assert (tmp_path / "figure.svg").exists()
    with pytest.raises(ValueError, match="no times"):
        figures.draw(Figure("work_precision"), [again.assign(seconds=again["seconds"] * np.nan)], tmp_path / "no.png")


def test_a_solver_that_misses_its_tolerance_has_a_status(monkeypatch, tmp_path):
    def stop(profile, loads, **settings):
        raise ConvergenceError("stopped")

    stopping = [replace(method, solve=stop) if method is bem.METHOD else method for method in registry.METHODS]
    monkeypatch.setattr(registry, "METHODS", tuple(stopping))
    data = small_trade(tmp_path, max_points=50)
    stopped = (data["solution_method"] == "bem").values
    assert np.isin(data["status"].values[:, stopped], [Status.not_converged, Status.not_requested]).all()
    assert np.isnan(data["seconds"].values[:, stopped]).all()
    assert (data["status"].sel(variant="demelio") == Status.solved).all()
