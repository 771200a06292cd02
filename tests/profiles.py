"""Profiles that several tests look at."""

import numpy as np

from weier import Profile

THREE_WAVES = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
TWIN_CRESTS = Profile(1.25, 2, 2, (0.0, np.pi))  # even in x, and highest at two positions: contacts come in pairs


def half_a_node_off(profile, points):
    """The same profile with all crests of all waves at one place, half a node off the grid."""
    return Profile(profile.D, profile.gamma, profile.m, [-np.pi * k / points for k in profile.waves_per_period])
