"""Curves within a tolerance: the terms and the method that are chosen, and that every answer is within it."""

import math

import numpy as np
import pytest

import weier
from tests.scenes import scene_in
from weier.methods import auto, patches
from weier.methods.errors import OutOfReachError
from weier.methods.method import TOLERANCES
from weier.surface.profile import Profile, random_phases

LOADS = np.array([1e-3, 0.03, 0.3, 1.0])
INFINITE = Profile(1.25, 5, math.inf, random_phases(3))
THREE = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))


def test_a_thousandth_of_the_infinite_series_takes_six_or_seven_terms():
    choice = weier.choose(Profile(1.25, 5, math.inf), 1e-3)
    assert choice.kept.m in (6, 7)
    # G_k = gamma^((D-2) k)/(1 - gamma^(D-2)), half of the tolerance at most, and more with a term less.
    tails = [5 ** (-0.75 * k) / (1 - 5**-0.75) for k in (choice.kept.m, choice.kept.m - 1)]
    assert choice.left_out == pytest.approx(tails[0], rel=1e-9)
    assert tails[0] <= 5e-4 < tails[1]
    assert choice.left_out + choice.settings["tolerance"] == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("profile", "tolerance"),
    [
        (INFINITE, 0.3),
        (INFINITE, 0.1),
        (Profile(1.2, "5/2", math.inf, 1.0), 0.5),
        (Profile(1.25, 2, 12, seed=1), 0.2),
    ],
)
def test_the_compliance_of_more_terms_is_within_the_tolerance(profile, tolerance):
    """By contact patches, with the bounds theorem for what even these leave out."""
    found = weier.solve(profile, LOADS, tolerance=tolerance)
    assert np.all(found.compliance_error <= tolerance * (1 + 1e-12))
    more = profile.truncated(int(found.chosen_terms) + 1)
    exact = patches.curve(more, LOADS).compliance
    rest = profile.total_amplitude - more.total_amplitude
    assert np.all(found.compliance - found.compliance_error <= exact + 2 * rest + 1e-9)
    assert np.all(exact - 1e-9 <= found.compliance + found.compliance_error)
    assert np.isnan(found.contact_fraction).all()
    assert found.chosen_method == "patches"  # whose bound is a theorem


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6])
def test_all_that_the_chosen_method_returns_is_passed_on(tolerance):
    choice = weier.choose(THREE, tolerance)
    own = weier.solve(THREE, LOADS, choice.method.name, contact_edges=True, **choice.settings)
    found = weier.solve(THREE, LOADS, tolerance=tolerance, contact_edges=True)
    assert {"contact_edge", "patch_count", "residual"} <= own.keys() == found.keys()
    for name in own:
        np.testing.assert_array_equal(found[name], own[name])


def test_quantities_of_the_contact_are_nan_where_terms_are_left_out():
    found = weier.solve(INFINITE, LOADS, tolerance=0.1, contact_edges=True)
    assert {name for name in found if np.isnan(found[name]).any()} == {
        "indentation",
        "area_coefficient",
        "contact_fraction",
        "contact_fraction_error",
        "elastic_energy",
        "patch_count",
    }
    assert found.sizes["edge"] == 0


@pytest.mark.parametrize("tolerance", [1e-2, 1e-5, 1e-9, 1e-13])
def test_all_terms_are_solved_where_none_may_be_left_out(tolerance):
    found, exact = weier.solve(THREE, LOADS, tolerance=tolerance), patches.curve(THREE, LOADS, 1e-13)
    assert np.all(np.abs(found.compliance - exact.compliance) <= tolerance)
    assert found.chosen_terms == 3
    assert found.chosen_method == ("bem" if tolerance == 1e-2 else "patches")  # which needs more nodes than usual


def test_a_trace_is_solved_whole():
    k = np.arange(1, 40)
    heights = np.fft.irfft(np.concatenate([[0], k**-1.2 * np.exp(1j * k**2)]), 200)
    trace = weier.Trace(1e-6 * heights, 1e-3, ends="periodic", unit="m")
    for tolerance in (1e-2, 1e-7):
        found, exact = weier.solve(trace, LOADS, tolerance=tolerance), patches.curve(trace, LOADS)
        assert np.all(np.abs(found.compliance - exact.compliance) <= tolerance)
        assert found.chosen_terms == trace.m


def test_a_series_beyond_reach_has_no_such_tolerance():
    with pytest.raises(
        OutOfReachError, match=r"no tolerance is within reach .* 17 terms are the most .*; take a shorter"
    ):
        weier.choose(Profile(1.9, 2, math.inf), 0.9)


@pytest.mark.parametrize("profile", [Profile(1.25, 5, math.inf), Profile(1.5, 2, 40)])
def test_a_refusal_names_the_least_tolerance_within_reach(profile):
    with pytest.raises(OutOfReachError, match="tolerance must be at least") as refused:
        weier.choose(profile, 1e-9)
    least = float(str(refused.value).split("at least ")[1].split()[0])
    assert weier.choose(profile, least).left_out <= least / 2
    with pytest.raises(OutOfReachError):
        weier.choose(profile, 0.9 * least)


@pytest.mark.parametrize(
    ("method", "gamma", "m", "reached", "beyond", "refusal"),
    [
        ("auto", [4, 3], "inf", 0.21, 0.17, "tolerance must be at least 2.0e-01"),
        ("bem", [3, 4], 6, 1e-6, 2e-9, "points for a tolerance"),
    ],
)
def test_a_scene_with_a_tolerance_out_of_reach_is_refused_as_it_is_read(
    method, gamma, m, reached, beyond, refusal, tmp_path
):
    """Also if it can be reached for the first D, and for the first gamma."""
    scene = {"title": "out of reach", "loads": [0.1], "methods": [method]}
    scene["studies"] = {"one": {"product": {"D": [1.3, 1.7], "gamma": gamma, "m": m}}}
    scene_in(tmp_path, scene | {"tolerance": reached})
    with pytest.raises(ValueError, match=refusal):
        scene_in(tmp_path, scene | {"tolerance": beyond})


def test_the_rest_of_a_tolerance_is_never_below_that_of_patches():
    """The tail of the steepest series is below half of the least tolerance; it must leave the least one as well."""
    steep = Profile(1.0001, 10**14, math.inf)
    tail = float(steep.amplitude_beyond(1))
    assert 0 < tail < TOLERANCES.least / 2
    for tolerance in (TOLERANCES.least, TOLERANCES.least + 0.9 * tail):
        with pytest.raises(OutOfReachError, match=r"at least 1.2e-13 g_0 for the compliance of .*: 1 terms are"):
            weier.choose(steep, tolerance)
    choice = weier.choose(steep, 1.2e-13)
    assert choice.settings["tolerance"] == 1.2e-13 - tail >= TOLERANCES.least


def test_a_resistance_is_within_its_tolerance_or_refused():
    found = weier.solve(THREE, LOADS, tolerance=1e-6, quantity="resistance")
    exact = patches.curve(THREE, LOADS, 1e-13).resistance
    assert np.all(found.resistance_error <= 1e-6 * np.maximum(exact, 1))
    assert np.all(np.abs(found.resistance - exact) <= 1e-6 * np.maximum(exact, 1))
    stated = patches.curve(THREE, LOADS, TOLERANCES.least)
    with pytest.raises(OutOfReachError, match=r"tolerance must be at least .* take a larger one, or leave them out"):
        weier.solve(THREE, LOADS, tolerance=1e-13, quantity="resistance")
    assert np.any(stated.resistance_error > 1e-13 * np.maximum(stated.resistance, 1))


@pytest.mark.parametrize(
    ("series", "tolerance"),
    [(INFINITE, 0.2), (Profile(1.1, 3, math.inf, random_phases(8)), 0.08), (Profile(1.5, 5, math.inf, 1.0), 0.3)],
)
def test_the_resistance_of_an_infinite_series_is_estimated(series, tolerance):
    """Against two more terms, which leave 0.04 to 0.2 of the amplitude that is left out."""
    loads = np.array([0.3, 1.0])
    choice = weier.choose(series, tolerance, "resistance")
    assert 4 * choice.left_out <= tolerance
    assert choice.kept.m == 3 or tolerance < 4 * series.amplitude_beyond(choice.kept.m - 1)
    found = weier.solve(series, loads, tolerance=tolerance, quantity="resistance")
    longer = patches.curve(series.truncated(int(found.chosen_terms) + 2), loads)
    assert np.all(found.resistance_error <= tolerance * np.maximum(found.resistance, 1))
    assert np.all(abs(longer.resistance - found.resistance) <= found.resistance_error)
    bounds = weier.solve(series, loads, tolerance=tolerance)
    assert np.all(found.resistance_error < 0.5 * bounds.resistance_error)


def test_the_resistance_of_an_infinite_series_just_above_a_birth_is_as_uncertain_as_that_of_its_first_terms():
    """The terms left out add more than that."""
    series, loads = Profile(1.25, 5, math.inf), [0.11297657214988815 * (1 + 1e-12)]
    found = weier.solve(series, loads, tolerance=0.9, quantity="resistance")
    first = weier.solve(series.truncated(int(found.chosen_terms)), loads, "patches")
    assert found.resistance_error.item() > 2 * first.resistance_error.item() > 0.2


def test_the_resistance_of_three_terms_is_estimated_where_no_more_can_be_resolved():
    found = weier.solve(Profile(1.25, 50, math.inf), [0.1], tolerance=0.3, quantity="resistance")
    assert found.chosen_terms == 3


def test_resistances_of_infinite_series_that_cannot_be_estimated_are_refused():
    rough = Profile(1.9, 2, math.inf)
    for loads, tolerance, message in (
        ([0.1], 0.05, r"no tolerance is within reach: .* is known to .* each of the 1\d more .* take heavier loads"),
        ([1e-2, 1.0], 0.5, "known to"),
        ([1e6], 0.5, "nearly in full contact; take lighter loads"),
    ):
        with pytest.raises(OutOfReachError, match=message):
            weier.solve(rough, loads, tolerance=tolerance, quantity="resistance")
    with pytest.raises(OutOfReachError, match="three truncations, and 2 terms are the most"):
        weier.solve(Profile(1.25, 500, math.inf), [0.1], tolerance=0.1, quantity="resistance")
    with pytest.raises(OutOfReachError, match="tolerance must be at least") as refused:
        weier.solve(INFINITE, [0.01], tolerance=1e-4, quantity="resistance")
    least = float(str(refused.value).split("at least ")[1].split(",")[0])
    assert weier.solve(INFINITE, [0.01], tolerance=least, quantity="resistance").resistance_error <= 12 * least


@pytest.mark.parametrize("tolerance", [9e-14, 1.0, math.nan])
def test_a_choice_takes_the_tolerances_of_curves(tolerance):
    for call in (lambda: weier.choose(THREE, tolerance), lambda: patches.curve(THREE, LOADS, tolerance)):
        with pytest.raises(ValueError, match=r"tolerance must lie in \[1e-13, 1\)"):
            call()


def test_no_method_means_auto_once_there_is_a_tolerance():
    assert weier.solve(THREE, [0.1], tolerance=1e-2).solution_method == "auto"
    assert weier.solve(THREE, [0.1]).solution_method == "patches"
    assert weier.solve(THREE, [0.1], "bem", tolerance=1e-2).solution_method == "bem"
    several = weier.solve([THREE, INFINITE], [0.1], tolerance=0.1)
    assert several.solution_method.values.tolist() == ["auto"]
    assert np.all(several.compliance_error <= 0.1)


def test_expected_seconds_are_those_of_the_method_that_is_chosen():
    for surface, method in ((INFINITE, "patches"), (THREE, "bem")):
        choice = weier.choose(surface, 1e-2)
        assert choice.method.name == method
        expected = choice.method.seconds(choice.kept, LOADS, **choice.settings)
        assert auto.METHOD.seconds(surface, LOADS, tolerance=1e-2) == expected > 0
    assert auto.METHOD.seconds(Profile(1.95, 2, math.inf), LOADS) == math.inf  # out of reach
