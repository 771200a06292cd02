"""Types of arrays for annotations, and arrays of records for kernels."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]
Spectrum = NDArray[np.complex128]
Records = NDArray[np.record]


def record_type(*fields: tuple[str, type, tuple[int, ...]]) -> np.dtype[np.record]:
    """Return the dtype of records with the given field names (separated by spaces), type and shape."""
    named = [(name, kind, shape) for names, kind, shape in fields for name in names.split()]
    return cast(np.dtype[np.record], np.dtype((np.record, named)))
