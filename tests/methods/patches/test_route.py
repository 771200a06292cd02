"""The route of a load: where it starts, what it is solved for, and one attempt on ordinary series."""

import numpy as np
import pytest

from tests.methods.patches.westergaard_states import KINDS
from weier import Profile, random_phases
from weier.methods.patches import solver
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.start import Starts


@pytest.mark.parametrize("D", [1.02, 1.25, 1.5, 1.75])
@pytest.mark.parametrize("gamma", [2, 5, "5/2"])
@pytest.mark.parametrize("m", [1, 2, 3, 4])
def test_an_ordinary_load_takes_the_first_attempt(D, gamma, m):
    """Random phases, from light loads to nearly full contact, on up to 125 waves."""
    profile = Profile(D, gamma, m, random_phases(round(100 * D) + m))
    starts = Starts(profile, solver.TOLERANCE)
    for load in np.geomspace(1e-6, 0.99 * starts.surface.full_contact_load, 9):
        state, steps = solver.solve_state(starts, float(load))
        assert state.route.attempts == 1
        assert state.route.steps == steps <= 20
        assert state.route.corrections <= 4


@pytest.mark.parametrize(
    ("load", "start", "dual"),
    [(1e-300, "crests", False), (1e-6, "crests", False), (0.5, "grid", False), (3.0, "grid", True)],
)
def test_each_part_of_a_curve_has_its_start(load, start, dual):
    state, _ = solver.solve_state(Starts(Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), 1e-10), load)
    assert (state.route.start, state.kind) == (start, KINDS[dual])


def test_the_last_gaps_start_on_crests_of_the_tension():
    starts = Starts(Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), 1e-10)
    state, _ = solver.solve_state(starts, starts.surface.full_contact_load * (1 - 1e-6))
    assert (state.route.start, state.kind) == ("tensions", GAPS)
