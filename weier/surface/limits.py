"""Limits of the solvers: the number of waves in a period, and of nodes of a grid."""

from __future__ import annotations

import math

from weier.checks import shown
from weier.surface.profile import Profile
from weier.surface.waves import MAX_POINTS, Waves

MAX_WAVES = 100_000  # finest waves per period: 6.4 million nodes by default, 1.2 GB


def resolvable(profile: Waves) -> bool:
    """Return whether the waves of one period can be sampled."""
    return profile.finest <= MAX_WAVES


def check_resolvable(profile: Waves) -> None:
    """Refuse a surface that has more finest waves per period than a computer can hold."""
    if not resolvable(profile):
        raise ValueError(
            f"the finest wave must fit at most {MAX_WAVES} times into the period, which {profile.describe()} "
            f"exceeds: take {_nearby_ratio(profile)}fewer terms, or a method that does not resolve every wave"
        )


def check_points(points: float) -> None:
    """Refuse a grid whose nodes no computer can hold."""
    if points > MAX_POINTS:
        raise ValueError(f"points must be at most {MAX_POINTS}, got {shown(points)}: take fewer")


def _nearby_ratio(profile: Waves) -> str:
    """Return advice to take a rational gamma close to the given one, if its period is short enough."""
    if not isinstance(profile, Profile):  # A trace has no gamma, and its waves are counted when it is made.
        return ""
    most = math.exp(math.log(MAX_WAVES) / (profile.m - 1)) * (1 + 1e-12)  # largest numerator
    denominator = int(most / float(profile.gamma))
    if denominator < 1:
        return ""
    # A suggestion is within 1 % of the given ratio and has a denominator of at most two digits.
    near = profile.gamma.limit_denominator(min(denominator, 99))
    if near <= 1 or near.numerator > most or abs(near / profile.gamma - 1) > 0.01:
        return ""
    return f'gamma = "{near}", which is {float(near):.6g}, or '
