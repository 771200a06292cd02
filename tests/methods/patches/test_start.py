"""Where loads start from: grids, and contacts that these miss."""

import numpy as np
import pytest

from tests.hard_series import hard_series
from tests.profiles import THREE_WAVES, TWIN_CRESTS
from weier import Profile, Trace, random_phases
from weier.methods import patches
from weier.methods.patches import solver, start
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.start import isolated_contacts, isolated_gaps
from weier.methods.patches.surface import surface_of


@pytest.mark.parametrize(
    ("edges", "merged"),
    [
        ([(0.1, 0.2), (0.15, 0.3), (0.4, 0.5)], [(0.1, 0.3), (0.4, 0.5)]),
        ([(0.4, 0.5), (0.1, 0.35), (0.15, 0.3)], [(0.1, 0.35), (0.4, 0.5)]),  # one within the other
        ([(0.9, 1.05), (0.02, 0.2), (0.4, 0.5)], [(0.4, 0.5), (0.9, 1.2)]),  # across the end of the period
        ([(0.1, 0.2), (0.3, 0.4)], [(0.1, 0.2), (0.3, 0.4)]),
    ],
)
def test_overlapping_intervals_are_merged(edges, merged, period):
    (left, right), (first, last) = (period * np.transpose(values) for values in (edges, merged))
    middle, half_width = start.merge_overlaps(np.stack([0.5 * (left + right), 0.5 * (right - left)]), period)
    np.testing.assert_allclose(middle, 0.5 * (first + last))
    np.testing.assert_allclose(half_width, 0.5 * (last - first))


@hard_series("gaps_at_any_tolerance")
def test_a_loose_tolerance_solves_for_the_gaps_that_a_tight_one_solves_for(profile, loads):
    for tolerance in (1e-4, 1e-10):
        (solution,) = patches.solve_loads(profile, loads, tolerance)
        assert solution.state.kind is GAPS


@pytest.mark.parametrize("load", [0.1, 0.9, 4.0])
def test_a_grid_finds_the_segments_of_the_solution(load):
    """All of them, contacts and gaps, with edges within a twentieth of the distance of its nodes."""
    guess, state = start.Starts(THREE_WAVES, 1e-10).guess(load), patches.solve_load(THREE_WAVES, load).state
    assert isolated_contacts(surface_of(THREE_WAVES).heights, load) is None
    assert guess.kind is state.kind
    found, exact = ((s.middle + side * s.half_width for side in (-1, 1)) for s in (guess.segments, state.segments))
    spacing = 1 / (start.POINTS_PER_WAVE * THREE_WAVES.waves_per_period[-1])
    for one, other in zip(found, exact, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=0.05 * spacing)


@pytest.mark.parametrize(("profile", "load"), [(TWIN_CRESTS, 1e-12), (TWIN_CRESTS, 1e-6), (THREE_WAVES, None)])
def test_isolated_contacts_and_gaps_are_those_of_the_solution(profile, load):
    """Half-widths that Hertz's theory gives, and their like just before full contact: (k a)^2 is left out."""
    surface = surface_of(profile)
    isolated, series = (isolated_contacts, surface.heights) if load else (isolated_gaps, surface.tensions)
    load = load or surface.full_contact_load * (1 - 1e-6)
    state = patches.solve_load(profile, load).state
    np.testing.assert_allclose(isolated(series, load).segments.half_width, state.segments.half_width, rtol=1e-2)
    assert isolated(series, 0.5) is None


@pytest.mark.parametrize(("phase", "load", "shift"), [(2.0, 0.03, 0.0317), (0.5, None, -0.0036)])
def test_segments_on_skew_crests_are_placed_by_the_third_derivative(phase, load, shift):
    """It moves a contact and a gap by this part of their half-width, the guess to a hundredth of that."""
    profile = Profile(1.5, 2, 2, (0, phase))
    surface = surface_of(profile)
    isolated, series = (isolated_contacts, surface.heights) if load else (isolated_gaps, surface.tensions)
    load = load or surface.full_contact_load * (1 - 3e-3)
    exact, guess = patches.solve_load(profile, load).state.segments, isolated(series, load).segments
    assert (exact.middle - exact.extent[0]) / exact.half_width == pytest.approx(shift, rel=0.01)
    assert np.abs(guess.middle - exact.middle) < 0.01 * abs(shift) * exact.half_width


def test_a_contact_on_many_weak_fine_waves_is_as_wide_as_the_guess():
    """The expansion goes as far as the finest wave allows; guesses that ended there were up to 7 times too narrow."""
    x = 2 * np.pi * np.arange(128) / 128
    heights = np.cos(x) - 0.2 * np.cos(2 * x) + 1e-4 * np.cos(20 * x + 1)
    starts = start.Starts(Trace(1e-8 * heights, 127e-6, unit="m", ends="periodic"), 1e-10)
    seen = 0
    for load in np.geomspace(1e-5, 0.1, 40):
        if (guess := isolated_contacts(starts.surface.heights, load)) is not None:
            state, _ = solver.solve_state(starts, load)
            assert guess.segments.half_width == pytest.approx(state.segments.half_width, rel=start.GUESS_TOLERANCE)
            seen += 1
    assert 10 < seen < 40


def test_forces_on_crests_are_those_of_one_plane():
    """Crests join, and leave where they would be pulled; the plane is known as well as the forces, to a hundredth."""
    rng = np.random.default_rng(0)
    for crests in rng.integers(3, 7, 200):
        x, curvature = (np.arange(crests) + 0.5 * rng.random(crests)) / crests, rng.uniform(50, 500, crests)
        offset, total = -rng.random(crests) * 10.0 ** rng.uniform(-6, -2), 10.0 ** rng.uniform(-7, -3)
        offset -= offset.max()
        parabolas = -0.5 * curvature[:, None] * (np.arange(5) == 2)  # expansions without a quartic term
        force = start._forces_on_crests(x, offset, parabolas, 1.0, 1.0, total, 1.0)
        assert force.sum() == pytest.approx(total, rel=2e-2)
        influence, loaded = -2 * np.log(np.abs(2 * np.sin(np.pi * (x[:, None] - x))) + np.eye(crests)), force > 0
        half_width = 2 * np.sqrt(force[loaded] / curvature[loaded])
        height = offset - influence @ force
        height[loaded] -= force[loaded] * (1 - 2 * np.log(np.pi * half_width))
        assert np.ptp(height[loaded]) < 2e-2 * total
        assert np.all(height[~loaded] < height[loaded].min() + 2e-2 * total)


@pytest.mark.parametrize("D", [1.02, 1.75])
@pytest.mark.parametrize("gamma", [2, "5/2"])
@pytest.mark.parametrize("m", [1, 2, 3])
def test_an_ordinary_load_takes_the_first_attempt(D, gamma, m):
    """Random phases, from light loads to nearly full contact, on up to 25 waves."""
    profile = Profile(D, gamma, m, random_phases(round(100 * D) + m))
    starts = start.Starts(profile, start.TOLERANCE)
    for load in np.geomspace(1e-6, 0.99 * starts.surface.full_contact_load, 9):
        state, steps = solver.solve_state(starts, float(load))
        assert state.attempts == 1
        assert state.steps == steps <= 20
        assert state.corrections <= 4
