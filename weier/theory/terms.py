"""The first terms of a series, and what they leave out."""

from __future__ import annotations

from weier.theory.phases import RandomPhases
from weier.theory.profile import Profile


def truncated(profile: Profile, terms: int) -> Profile:
    """The first terms of a profile."""
    if isinstance(profile.phases, float | RandomPhases):
        return Profile(profile.D, profile.gamma, terms, profile.phases)
    return Profile(profile.D, profile.gamma, terms, profile.phases[:terms])


def left_out(profile: Profile, terms: float) -> float:
    """Amplitude of the terms from here on, in g_0."""
    if terms == profile.m:
        return 0.0
    return profile.total_amplitude - truncated(profile, int(terms)).total_amplitude
