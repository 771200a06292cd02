"""The limit of solvers on the number of waves in a period."""

from __future__ import annotations

from weier.surface.waves import Waves

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
