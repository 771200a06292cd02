"""Keys that identify surfaces and cases: sums of digests of their parameters.

The sum is modulo 2^64 in each of two words, so that the keys of a million cases are sums of arrays. Two of n cases
have the same key with a probability of n^2/2^129, since digests are as good as random.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Indices

Keys: TypeAlias = NDArray[np.uint64]  # two words each, shape (..., 2)
WORDS = "<u8"


def key_of(value: Any) -> Keys:
    """Return the key of a plain value, shape (2,)."""
    text = json.dumps(value, sort_keys=True)
    return np.frombuffer(hashlib.sha256(text.encode()).digest()[:16], WORDS)


def keys_of(values: Iterable[Any]) -> Keys:
    """Return the keys of plain values, shape (values, 2)."""
    return np.array([key_of(value) for value in values], WORDS).reshape(-1, 2)


def as_text(keys: Keys) -> str:
    """Return keys as hexadecimal digits, 32 each."""
    return np.ascontiguousarray(keys, WORDS).tobytes().hex()


def from_text(text: str) -> Keys:
    """Return the keys that `as_text` has written, shape (keys, 2)."""
    return np.frombuffer(bytes.fromhex(text), WORDS).reshape(-1, 2)


def digest_of_keys(keys: Keys) -> str:
    """Return a digest of keys in their order: a tenth of the time of one of their digits."""
    return hashlib.sha256(np.ascontiguousarray(keys, WORDS).data).hexdigest()


def distinct(keys: Keys) -> tuple[Indices, Indices]:
    """Return the first position of each distinct key, increasing, and the number of its own for every key."""
    order = _sorted(keys)
    new = np.ones(len(keys), bool)
    new[1:] = (keys[order][1:] != keys[order][:-1]).any(axis=1)
    first = order[new]  # of each group, since the sort is stable
    rank = np.empty(len(first), int)
    rank[np.argsort(first)] = np.arange(len(first))
    number = np.empty(len(keys), int)
    number[order] = rank[np.cumsum(new) - 1]
    return np.sort(first), number


def ordered(keys: Keys) -> Keys:
    """Return keys in their order."""
    return keys[_sorted(keys)]


class Lookup:
    """The positions of keys in a table; where a key occurs several times, its first position."""

    def __init__(self, keys: Keys) -> None:
        self._order = _sorted(keys)
        self._keys = keys[self._order]

    def find(self, wanted: Keys) -> Indices:
        """Return the position of each key, or -1 where the table does not have it."""
        found = np.full(len(wanted), -1)
        if not len(self._keys):
            return found
        # Keys of the same first word are adjacent, and hardly ever several.
        place = np.searchsorted(self._keys[:, 0], wanted[:, 0])
        left = np.arange(len(wanted))
        while left.size:
            inside = place[left] < len(self._keys)
            left = left[inside]
            here = self._keys[place[left]]
            same = (here == wanted[left]).all(axis=1)
            found[left[same]] = self._order[place[left[same]]]
            left = left[~same & (here[:, 0] == wanted[left, 0])]
            place[left] += 1
        return found


def _sorted(keys: Keys) -> Indices:
    """Return the positions of keys in their order, equal ones by position."""
    order = np.argsort(keys[:, 0])
    first = keys[order, 0]
    # Different keys hardly ever have the same first word: sorting by one word takes a third of the time.
    return np.lexsort((keys[:, 1], keys[:, 0])) if (first[1:] == first[:-1]).any() else order
