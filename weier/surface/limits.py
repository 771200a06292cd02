"""Limits of the solvers: the number of waves in a period, and of nodes of a grid."""

from __future__ import annotations

from weier.checks import shown
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
            "exceeds: take fewer terms, a gamma of smaller numbers, such as 5/2, or a method that does not resolve "
            "every wave"
        )


def check_points(points: float) -> None:
    """Refuse a grid whose nodes no computer can hold."""
    if points > MAX_POINTS:
        raise ValueError(f"points must be at most {MAX_POINTS}, got {shown(points)}: take fewer")
