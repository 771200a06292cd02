"""Where each load starts from."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES, TWIN_CRESTS
from weier import Profile
from weier.methods import patches
from weier.methods.patches.start import lone_contacts, lone_gaps
from weier.methods.patches.surface import surface_of


@pytest.mark.parametrize("shift", [0.0, 1e-10, -1e-10, 1e-9, -1e-9, 1e-8])
def test_loads_on_an_event_are_solved(shift):
    events = patches.events(THREE_WAVES, 0.15, 0.35)
    assert events.mean_pressure.size >= 4
    for load, birth in zip(events.mean_pressure, events.birth, strict=True):
        below, at, above = patches.curve(THREE_WAVES, load * np.array([1 - 1e-4, 1 + shift, 1 + 1e-4])).resistance
        assert below > at > above
        # At a birth dh/dp falls like 1/ln of the distance; at a merger it bends.
        assert below - above < (0.3 if birth else 1e-3) * at


@pytest.mark.parametrize("loads", [[1e-300, 1e-200], [1e-300, 1e300]])
def test_loads_of_any_size(loads):
    curve = patches.curve(THREE_WAVES, loads)
    assert np.all(np.isfinite(curve.compliance))
    with pytest.raises(ValueError, match="must be at least 1e-300"):
        patches.curve(THREE_WAVES, [1e-308, *loads])


@pytest.mark.parametrize(("profile", "load"), [(TWIN_CRESTS, 1e-12), (TWIN_CRESTS, 1e-6), (THREE_WAVES, None)])
def test_lone_contacts_and_gaps_are_those_of_the_solution(profile, load):
    """Half-widths that Hertz's theory gives, and the like of it just before full contact: (k a)^2 is left out."""
    surface = surface_of(profile)
    lone, series = (lone_contacts, surface.heights) if load else (lone_gaps, surface.tensions)
    load = load or surface.full_contact_load * (1 - 1e-6)
    state = patches.solve_load(profile, load).state
    np.testing.assert_allclose(lone(series, load).segments.half_width, state.segments.half_width, rtol=1e-2)
    assert lone(series, 0.5) is None


def test_newton_takes_few_steps():
    """Boundary elements tell contacts and edges: two to four steps on few nodes, and as many corrections."""
    assert patches.curve(THREE_WAVES, np.geomspace(1e-3, 4, 25)).work.max() <= 12


def test_a_far_load_of_a_symmetric_profile_takes_few_steps():
    """Contacts that are born in pairs must not overlap, for then they would take thousands of nodes."""
    assert patches.curve(Profile(1.5, 3, 4), np.geomspace(1e-3, 10, 8)).work.max() < 30
