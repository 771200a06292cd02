"""From load to load, near and far."""

from itertools import pairwise

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import Profile
from weier.methods import patches


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


def test_a_load_of_another_size_moves_no_contact_far():
    """The tangent over 150 decades of load multiplies rounding: it must not move the contact by many periods."""
    profile, loads = Profile(1.000000001, 5, 2, (1.000000001, 0.0)), [6.666586845037927e-285, 5.772493106428526e-131]
    curve = patches.curve(profile, loads)
    alone = [patches.curve(profile, load).resistance[0] for load in loads]
    np.testing.assert_allclose(curve.resistance, alone, rtol=1e-9)


def test_a_far_load_of_a_symmetric_profile_takes_few_steps():
    """Contacts that are born in pairs must not overlap, for then they would take thousands of nodes."""
    assert patches.curve(Profile(1.5, 3, 4), np.geomspace(1e-3, 10, 8)).work.max() < 30


def test_contacts_only_grow():
    for lighter, heavier in pairwise(patches.curve(THREE_WAVES, np.geomspace(1e-3, 2, 14)).contact_edge):
        before, after = (edges[np.isfinite(edges)].reshape(-1, 2) for edges in (lighter, heavier))
        for left, right in before:
            assert np.any((left - after[:, 0]) % 1 + (right - left) <= after[:, 1] - after[:, 0])
