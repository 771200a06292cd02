"""The methods that more than one place must tell from the others, by their names."""

from __future__ import annotations

NUMERICAL = ("patches", "bem")  # solve the series itself, on all of its waves; the more accurate first
PLANNED = "planned"  # runs whichever of the others meets a tolerance
