"""Keys that identify surfaces and cases: sums of digests of their parameters.

The sum is modulo 2^64, so that the keys of a million cases are sums of arrays. Two of n cases have the same key with
a probability of n^2/2^65, 3e-8 for a million, since digests are as good as random.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Indices

Keys: TypeAlias = NDArray[np.uint64]
WORD = "<u8"


def key_of(value: Any) -> np.uint64:
    """Return the key of a plain value."""
    text = json.dumps(value, sort_keys=True)
    return np.uint64(np.frombuffer(hashlib.sha256(text.encode()).digest()[:8], WORD)[0])


def keys_of(values: Iterable[Any]) -> Keys:
    """Return the keys of plain values."""
    return np.array([key_of(value) for value in values], np.uint64)


def as_text(keys: Keys) -> str:
    """Return keys as hexadecimal digits, 16 each."""
    return np.ascontiguousarray(keys, WORD).tobytes().hex()


def from_text(text: str) -> Keys:
    """Return the keys that `as_text` has written."""
    return np.frombuffer(bytes.fromhex(text), WORD)


def digest_of_keys(keys: Keys) -> str:
    """Return a digest of keys in their order: a tenth of the time of one of their digits."""
    return hashlib.sha256(np.ascontiguousarray(keys, WORD).data).hexdigest()


def distinct(keys: Keys) -> tuple[Indices, Indices]:
    """Return the first position of each distinct key, increasing, and the number of its own for every key."""
    _, first, number = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(first), int)
    rank[order] = np.arange(len(first))
    return first[order], rank[number]


class Lookup:
    """The positions of keys in a table; where a key occurs several times, its first position."""

    def __init__(self, keys: Keys) -> None:
        self._keys, self._first = np.unique(keys, return_index=True)

    def find(self, wanted: Keys) -> Indices:
        """Return the position of each key, or -1 where the table does not have it."""
        place = np.searchsorted(self._keys, wanted)
        return np.where(np.append(self._keys, 0)[place] == wanted, np.append(self._first, -1)[place], -1)
