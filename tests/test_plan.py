"""What a tolerance takes: the laws hold, the plan keeps its word, and says why."""

import math

import numpy as np
import pytest

import weier
from weier import Profile, laws, patches, random_phases, scene
from weier.bounds import compliance_bounds
from weier.plan import OutOfReachError, left_out, plan, truncated
from weier.plans import describe_plans
from weier.solve import NotApplicableError
from weier.tradeoff.verify import verify

LOADS = np.geomspace(1e-3, 10, 12)
PROFILE = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))


def test_planned_curves_are_within_the_errors_they_expect():
    """All of 200 others did: of 20, none may miss."""
    found = list(verify(20, seed=1))
    assert len({each.methods[0] for each in found}) >= 3
    assert {each.quantity for each in found} == {"compliance", "resistance"}
    assert [each for each in found if not each.inside or each.expected > each.tolerance] == []


@pytest.mark.parametrize("D", [1.15, 1.6])
@pytest.mark.parametrize("per_wave", [12, 40, 128])
def test_boundary_elements_follow_their_law_and_not_by_far(D, per_wave):
    profile = Profile(D, 2, 4, random_phases(3))
    exact = patches.curve(profile, LOADS)
    points = per_wave * profile.wavenumber[-1]
    error = np.abs(weier.bem.curve(profile, LOADS, points=points).compliance - exact.compliance).max()
    expected = laws.bem_compliance_error(profile, points)
    assert expected / 10 < error <= expected


@pytest.mark.parametrize("error", [0.3, 1e-2, 1e-4])
@pytest.mark.parametrize("quantity", ["compliance", "resistance"])
def test_points_are_the_fewest_that_do(quantity, error):
    law = {"compliance": laws.bem_compliance_error, "resistance": laws.bem_resistance_error}[quantity]
    points = laws.bem_points(PROFILE, error, quantity)
    waves = PROFILE.wavenumber[-1]
    assert law(PROFILE, points) <= error * (1 + 1e-12)
    # Rounded up to what halves: by 1 in 8 at most, and 1 in 4 of the points is half of the error.
    assert points == 12 * waves or law(PROFILE, int(points * 0.75)) > error


def test_a_finer_tolerance_takes_no_less():
    seconds = [plan(PROFILE, LOADS, tolerance).seconds for tolerance in (0.5, 1e-1, 1e-2, 1e-4, 1e-6, 1e-9)]
    assert seconds == sorted(seconds)
    assert seconds[0] < seconds[-1] / 10


@pytest.mark.parametrize("tolerance", [0.5, 1e-2, 1e-4, 1e-9])
@pytest.mark.parametrize("quantity", ["compliance", "resistance"])
def test_the_parts_cover_the_loads_and_add_up(quantity, tolerance):
    found = plan(PROFILE, LOADS, tolerance, quantity)
    assert np.array_equal(np.concatenate([part.mean_pressure for part in found.parts]), LOADS)
    assert found.error == max(p.truncation + p.discretisation + p.estimate for p in found.parts) <= tolerance
    assert found.parts[-1].method == "full contact"
    assert str(found).count("\n") == 1 + len(found.parts)


def test_full_contact_is_closed_form_and_exact():
    curve = weier.solve(PROFILE, [5.0, 10.0], "planned")
    exact = weier.solve(PROFILE, [5.0, 10.0], "patches")
    assert np.all(curve.compliance == exact.compliance)
    assert np.all(curve.resistance == 0)
    assert np.all(curve.compliance_error == 0)


def test_terms_that_a_tolerance_does_not_need_are_left_out_within_the_bounds():
    (part, _) = plan(PROFILE, LOADS, 0.2).parts
    assert part.terms == 2
    assert part.truncation == pytest.approx(PROFILE.amplitude[2])
    kept = patches.curve(truncated(PROFILE, 2), LOADS).compliance
    low, high = compliance_bounds(kept + left_out(PROFILE, 2), part.truncation)
    exact = patches.curve(PROFILE, LOADS).compliance
    assert np.all((low <= exact) & (exact <= high))


def test_one_wave_is_a_closed_form():
    found = plan(Profile(1.5, 3, 1), LOADS, 1e-9)
    assert [part.method for part in found.parts] == ["westergaard", "full contact"]


def test_an_endless_series_resolves_what_its_tail_demands():
    (part,) = plan(Profile(1.25, 5, math.inf), LOADS, 1e-2).parts
    assert part.method == "bem"
    assert part.truncation == pytest.approx(Profile(1.25, 5, int(part.terms)).tail_amplitude)
    assert Profile(1.25, 5, int(part.terms) - 1).tail_amplitude > 1e-2


def test_what_is_out_of_reach_is_refused_with_what_is_missing():
    endless = Profile(1.9, 2, math.inf)
    with pytest.raises(OutOfReachError, match="the others may change it by"):
        plan(endless, LOADS, 1e-3)
    with pytest.raises(NotApplicableError, match="tolerance must be larger"):
        weier.solve(endless, LOADS, "planned", tolerance=1e-3)


@pytest.mark.parametrize(("tolerance", "quantity"), [(0.0, "compliance"), (math.nan, "compliance"), (1e-3, "gap")])
def test_bad_requests_are_refused(tolerance, quantity):
    with pytest.raises(ValueError, match=r"tolerance must be positive|quantity must be one of"):
        plan(PROFILE, LOADS, tolerance, quantity)


SCENE = """
title: planned
loads: [0.01, 0.1, 20]
tolerance: 1.0e-3
studies:
  one: {product: {D: [1.25, 1.5], gamma: 5, m: 2, phase: 1.0}}
"""


def test_a_scene_with_a_tolerance_runs_its_plan(tmp_path):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE)
    loaded = scene.load(path)
    text = describe_plans(loaded)
    assert text.count("bem with 2 terms") == 2
    assert "2 of 2 cases can be solved" in text
    data, _ = weier.batch.solve_batch(loaded, loaded.studies["one"])
    assert data.method.values.tolist() == ["planned"]
    for case in range(2):
        exact = patches.curve(loaded.studies["one"][case].profile, loaded.loads).compliance
        error = np.abs(data.compliance.values[case, 0] - exact)
        assert np.all(error <= data.compliance_error.values[case, 0])
        assert 0 < data.compliance_error.values[case, 0, 0] <= 1e-3


@pytest.mark.parametrize(
    ("old", "new"), [("tolerance: 1.0e-3\n", ""), ("1.0e-3", "0"), ("tolerance: 1.0e-3", "quantity: compliance")]
)
def test_a_scene_needs_methods_or_a_tolerance(tmp_path, old, new):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE.replace(old, new))
    with pytest.raises(scene.SceneError):
        scene.load(path)
