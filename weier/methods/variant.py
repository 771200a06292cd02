"""One competitor of a comparison: a method with its settings, by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple


class Contender(NamedTuple):
    """A name of at most 16 letters, a method of weier.solve and its settings."""

    name: str
    method: str
    settings: Mapping[str, Any]
