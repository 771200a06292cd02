"""One step on the edges of contacts or gaps."""

import numpy as np
import pytest

from weier import Profile
from weier.kernels.blas import one_thread
from weier.methods.patches.edge_iteration import Problem, Stage, make_guess, next_guess, take_step
from weier.methods.patches.given_edges import Bounds
from weier.methods.patches.segments import from_crests, make_segments
from weier.methods.patches.surface import surface_of

STAGE = Stage(True, 1e-12, Bounds(1e-10, 1e-14, 1e-10), 0.0, 0.0, 0.0)


@one_thread
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize(("load", "error"), [(0.02, 0.5), (0.02, -0.4), (0.99, 0.5), (0.99, -0.4)])
def test_a_small_contact_or_gap_is_right_after_one_step(load, error, dual):
    profile = Profile(1.5, 3, 1)
    contact = np.arcsin(np.sqrt(load)) / np.pi
    middle, exact = (0.5, 0.5 - contact) if dual else (0.0, contact)
    small = min(exact, 0.5 - exact)
    half_width = exact * (1 + error) if small == exact else 0.5 - small * (1 + error)
    problem = Problem(surface_of(profile).series(dual), load, dual)
    placed = *from_crests(problem.series, np.array([middle])), np.array([half_width])
    guess = make_guess(problem, make_segments(*placed, np.ones(1, int)), STAGE)
    step = take_step(problem, guess, STAGE)
    moved = next_guess(problem, step, STAGE).punches.segments.half_width[0]
    # The closed forms are those of a parabola, from which the wave differs by the square of this scale in radians.
    # Beside a narrow contact the gap's far field takes part as well, by a logarithm: the rule is of first order.
    limit = 2 * (np.pi * small) ** 2 if not (dual and load < 0.5) else 0.5 * abs(error)
    assert abs(moved - exact) < limit * small
    assert abs(half_width - exact) > 0.3 * small
