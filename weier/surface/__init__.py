"""Surfaces: the series and its phases, waves of any surface, crests, the spectrum, and measured heights."""
