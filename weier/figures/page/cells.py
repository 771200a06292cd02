"""Numbers and labels as they stand in the cells of a page's tables."""

from __future__ import annotations

import numpy as np


def largest(values: np.ndarray, unknown: str = "") -> str:
    """The largest of those values that are known, or the word `unknown` where none is."""
    known = values[~np.isnan(values)]
    return f"{known.max():.1e}" if known.size else unknown


def coordinate_text(value: str | float) -> str:
    """A label of a case as text: none where it is missing."""
    return value if isinstance(value, str) else f"{value:.6g}" if np.isfinite(value) else ""
