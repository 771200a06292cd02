"""What the solvers can hold: waves of a period, and nodes of a grid."""

from __future__ import annotations

import math

from weier.theory.arguments import shown
from weier.theory.profile import Profile
from weier.theory.waves import MAX_POINTS, Waves

MAX_WAVES = 100_000  # of the finest wave in one period: 6.4 million nodes by default, 1.2 gigabytes
NEARBY = 0.01  # relative: a ratio that stands in for one that has no period, or too long a one
NEARBY_DENOMINATOR = 99
MAX_DENSE_POINTS = 10_000  # nodes of a dense matrix, which takes 0.8 GB, and its factors as much


def resolvable(profile: Waves) -> bool:
    """Whether the waves of one period can be sampled."""
    return profile.finest <= MAX_WAVES


def check_resolvable(profile: Waves) -> None:
    """Refuse a surface whose finest wave fits more often into the period than a computer can hold."""
    if not resolvable(profile):
        raise ValueError(
            f"the finest wave must fit at most {MAX_WAVES} times into the period, which {profile.describe()} "
            f"exceeds: take {_nearby_ratio(profile)}fewer terms, or a method that does not resolve every wave"
        )


def check_points(points: float, dense: bool = False) -> None:
    """Refuse a grid whose nodes, or whose dense matrix, no computer can hold."""
    most, instead = (MAX_DENSE_POINTS, 'take solver "fft", or fewer') if dense else (MAX_POINTS, "take fewer")
    if points > most:
        raise ValueError(f"points must be at most {most}, got {shown(points)}: {instead}")


def _nearby_ratio(profile: Waves) -> str:
    """Advice where a gamma near to the one asked for has a period that can be held: its first few digits do."""
    if not isinstance(profile, Profile):  # a trace has a ratio of no waves, and never too many of them
        return ""
    most = math.exp(math.log(MAX_WAVES) / (profile.m - 1)) * (1 + 1e-12)  # numerator, whose power is a whole number
    denominator = int(most / float(profile.gamma))
    if denominator < 1:
        return ""
    near = profile.gamma.limit_denominator(min(denominator, NEARBY_DENOMINATOR))
    if near <= 1 or near.numerator > most or abs(near / profile.gamma - 1) > NEARBY:
        return ""
    return f'gamma = "{near}", which is {float(near):.6g}, or '
