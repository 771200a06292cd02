"""What the solver needs to know of a profile: its heights and its full-contact pressures, seen from their summits."""

from __future__ import annotations

from typing import NamedTuple

from weier.methods.patches.waves import Waves, make_waves
from weier.theory.limits import check_resolvable
from weier.theory.profile import Profile


class Surface(NamedTuple):
    """The heights, and the full-contact pressures with their sign turned.

    heights : z, in g_0: on its highest summit is the first contact
    pressures : -p_full, in p_0*: on its highest summit is the last gap
    total_amplitude : sum g_n, in g_0
    """

    heights: Waves
    pressures: Waves
    total_amplitude: float

    @property
    def full_load(self) -> float:
        """Mean pressure from which on contact is full, in p_0*."""
        return self.pressures.top

    def of(self, dual: bool) -> Waves:
        """The series that the problem for contacts, or for gaps (dual), looks at."""
        return self.pressures if dual else self.heights


def surface_of(profile: Profile) -> Surface:
    """What the solver needs to know of a profile.

    Raises
    ------
    ValueError
        If its waves are too many for a computer.
    """
    check_resolvable(profile)
    series = profile.wavenumber, profile.phase, profile.period
    return Surface(
        make_waves(profile.amplitude, *series),
        make_waves(-profile.full_contact_pressure, *series),
        profile.total_amplitude,
    )
