"""Keys that identify surfaces and cases: sums of digests of their parameters.

The sum is modulo 2^64, so that the keys of a million cases are sums of arrays. Two of n cases have the same key with
a probability of n^2/2^65, 3e-8 for a million, since digests are as good as random.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from weier.digests import digest
from weier.kernels.arrays import Indices

Keys: TypeAlias = NDArray[np.uint64]
WORD = "<u8"


def keys_of(values: Iterable[Any]) -> Keys:
    """Return the keys of plain values."""
    return np.frombuffer(bytes.fromhex("".join(digest(value)[:16] for value in values)), WORD)


def short_keys(keys: Keys) -> list[str]:
    """Return keys as files have them: the first 12 of 16 hexadecimal digits."""
    text = np.ascontiguousarray(keys, WORD).tobytes().hex()
    return [text[start : start + 12] for start in range(0, len(text), 16)]


def distinct(keys: Keys) -> tuple[Indices, Indices]:
    """Return the increasing first positions of distinct keys, and the index among these of every key."""
    _, first, number = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return first[order], np.argsort(order)[number]
