"""One load: convergence, the agreement of the two problems, and what cannot be solved."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import ConvergenceError
from weier.methods import patches
from weier.methods.patches import active_set
from weier.methods.patches.active_set import solve_on_segments
from weier.methods.patches.continuation import first_state
from weier.methods.patches.initial_guess import InitialGuess, sort_segments, transfer_density
from weier.methods.patches.newton import NewtonStatus
from weier.methods.patches.surface import surface_of


@pytest.mark.parametrize(("load", "counts"), [(0.05, range(4, 13)), (0.7, range(12, 29, 2))])
def test_convergence_is_exponential_in_nodes(load, counts):
    surface = surface_of(THREE_WAVES)
    state, _ = first_state(THREE_WAVES, surface, load, 1e-12)
    old, errors = state.segments, []
    for count in counts:
        node_count = np.full(old.centre.size, count)
        guess, _ = transfer_density(surface, state, old.crest, old.centre, old.half_width, node_count)
        fewer, result = solve_on_segments(surface, guess, load, 1e-12)
        assert result.status == NewtonStatus.converged
        errors.append(abs(fewer.approach / state.approach - 1) + 1e-16)
    rate = -np.polyfit(counts, np.log(errors), 1)[0]
    print(f"load {load}: error falls {np.exp(rate):.1f} times a node; {errors[0]:.0e} to {errors[-1]:.0e}")
    assert rate > 0.5
    assert errors[-1] < 1e-9


def test_contacts_and_gaps_are_one_solution():
    """The two problems, for pressure in contacts and for slope in gaps, have nothing but the profile in common."""
    surface = surface_of(THREE_WAVES)
    load = 2.5
    dual, _ = first_state(THREE_WAVES, surface, load, 1e-10)
    assert dual.dual
    gaps = patches.solve_load(THREE_WAVES, load)
    heights = surface.heights
    crest = np.array([np.argmin(np.abs((heights.crest_position - x + 0.5) % 1 - 0.5)) for x in gaps.centre])
    centre = (gaps.centre - heights.crest_position[crest] + 0.5) % 1 - 0.5
    segments, order = sort_segments(heights, crest, centre, gaps.half_width * 0.999, np.full(crest.size, 80))
    phi = [gaps.pressure(gaps.centre[j] + gaps.half_width[j] * segments.node[:80] * 0.999) for j in order]
    phi = np.concatenate(phi) / np.sqrt(1 - segments.node**2)
    guess = InitialGuess(False, segments, phi, 0.0)
    primal, result = solve_on_segments(surface, guess, load, 1e-10)
    assert result.status == NewtonStatus.converged
    assert primal.approach == pytest.approx(heights.maximum + dual.approach, abs=1e-10)
    assert primal.sensitivity[-1] == pytest.approx(dual.sensitivity[-1], rel=1e-8)


def test_too_many_unknowns_raise(monkeypatch):
    monkeypatch.setattr(active_set, "MAX_UNKNOWNS", 20)
    with pytest.raises(ConvergenceError, match="unknowns, more than 20"):
        patches.curve(THREE_WAVES, 2.0)


def test_a_residual_above_the_tolerance_raises(monkeypatch):
    monkeypatch.setattr(active_set, "contact_residual", lambda *_: 1e-3)
    with pytest.raises(ConvergenceError):
        patches.curve(THREE_WAVES, 0.1)
