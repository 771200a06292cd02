"""Numbers as they stand in the cells of a page's tables."""

from __future__ import annotations

import numpy as np


def largest(values: np.ndarray, unknown: str = "") -> str:
    """The largest of those values that are known, or the word `unknown` where none is."""
    known = values[~np.isnan(values)]
    return f"{known.max():.1e}" if known.size else unknown
