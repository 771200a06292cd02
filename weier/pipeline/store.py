"""Solved curves in append-only segments: files of rows, each with its key.

`results/curves/KIND/NUMERICS/*.npz` are the segments of a kind under one numerics, and `KIND/kind.json` describes the
kind. A segment is written to a temporary file, synced and renamed, and never changed; its name ends in its checksum.
If two runs have solved the same curve, two segments hold its key, and either may be read.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import time
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.data.files import replacing, write_text
from weier.kernels.arrays import Flags, Indices
from weier.pipeline.needed_curves import Kind, Part, each_once
from weier.scene.identity import Keys

KEY, ORIGIN = "key", "origin"  # one key per row, one origin per segment
SUFFIX = ".npz"
DAMAGED = "{} is damaged: move it away and run snakemake again, which solves its curves anew"


class Index(NamedTuple):
    """The rows of a kind, numbered through its segments.

    files, columns, origins, starts : of each segment, the path, names of columns, origin and number of its first row
    keys, rows : the distinct keys in increasing order, and a row of each
    """

    files: Sequence[Path]
    columns: Sequence[Collection[str]]
    origins: Sequence[str]
    starts: Indices
    keys: Keys
    rows: Indices

    def find(self, keys: Keys) -> tuple[Flags, Indices]:
        """Return whether each key has a row, and its position in the index."""
        place = np.searchsorted(self.keys, keys)
        return np.append(self.keys, np.uint64(0))[place] == keys, place  # 0 is not above all other keys


class Store:
    """The solved curves of one folder, such as results/curves, under one numerics."""

    def __init__(self, folder: str | Path, numerics: str) -> None:
        self.folder, self.numerics = Path(folder), numerics
        self._indices: dict[str, Index] = {}

    def lacking(self, wanted: Iterable[Part]) -> list[Part]:
        """Return the parts reduced to curves that the store lacks, each curve once."""
        lacking = (part.only(~self.index(part.kind.name).find(part.keys)[0]) for part in each_once(wanted))
        return [part for part in lacking if part.cases.size]

    def rows(self, kind: Kind, keys: Keys) -> Indices:
        """Return where curves are; ValueError if one is not solved."""
        index = self.index(kind.name)
        known, place = index.find(keys)
        if not known.all():
            raise ValueError(f"{(~known).sum()} curves by {kind.method} are not solved: run snakemake again")
        return index.rows[place]

    def read(self, kind: Kind, rows: Indices, name: str) -> NDArray[Any] | None:
        """Return a variable of the curves in `rows`, shape (rows, ...), NaN or "" if missing; None if none has it."""
        index = self.index(kind.name)
        segment = np.searchsorted(index.starts, rows, "right") - 1
        if name == ORIGIN:
            return np.array(index.origins, object)[segment]
        found = list[tuple[Indices, NDArray[Any]]]()
        for number in np.flatnonzero(np.bincount(segment)).tolist():  # those that have rows
            if name in index.columns[number]:
                here = np.flatnonzero(segment == number)
                with np.load(index.files[number]) as columns:
                    found.append((here, columns[name][rows[here] - index.starts[number]]))
        return _joined(rows.size, found) if found else None

    def append(self, kind: Kind, rows: Mapping[np.uint64, Mapping[str, Any]], origin: str) -> None:
        """Append curves as one segment, atomically: the data are synced to disk before the file gets its name."""
        if not (about := self.folder / kind.name / "kind.json").exists():
            write_text(about, json.dumps(asdict(kind), indent=1, sort_keys=True) + "\n")
        columns = {KEY: np.array([*rows], np.uint64), ORIGIN: np.array(origin)}
        for name in dict.fromkeys(name for row in rows.values() for name in row):
            values = [(slice(n, n + 1), np.array([row[name]])) for n, row in enumerate(rows.values()) if name in row]
            columns[name] = _joined(len(rows), values)
        np.savez_compressed(content := io.BytesIO(), allow_pickle=False, **columns)
        path = self.segments(kind.name) / f"{time.time_ns():x}-{_checksum(content.getvalue())}{SUFFIX}"
        with replacing(path) as temporary, temporary.open("wb") as file:
            file.write(content.getvalue())
            file.flush()
            os.fsync(file.fileno())
        self._indices.pop(kind.name, None)

    def segments(self, kind: str) -> Path:
        """Return the folder with the segments of a kind."""
        return self.folder / kind / self.numerics

    def index(self, kind: str) -> Index:
        """Return the rows of a kind; ValueError if a segment is damaged."""
        if kind not in self._indices:
            files = sorted(self.segments(kind).glob(f"[!.]*{SUFFIX}"))
            names, origins, keys = list[Collection[str]](), [], [np.empty(0, np.uint64)]
            for file in files:
                content = file.read_bytes()
                if not file.stem.endswith(_checksum(content)):
                    raise ValueError(DAMAGED.format(file))
                with np.load(io.BytesIO(content)) as columns:
                    names.append(columns.files)
                    origins.append(str(columns[ORIGIN]))
                    keys.append(columns[KEY])
            starts = np.cumsum([len(own) for own in keys])[:-1]
            self._indices[kind] = Index(
                files, names, origins, starts, *np.unique(np.concatenate(keys), return_index=True)
            )
        return self._indices[kind]


def _checksum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def _joined(count: int, parts: Sequence[tuple[Indices | slice, NDArray[Any]]]) -> NDArray[Any]:
    """Combine values of some rows each into an array, shape (count, ...).

    Shorter rows end in NaN, and missing ones are NaN or "", so that integers become floats.
    """
    shape = np.max([values.shape[1:] for _, values in parts], axis=0).astype(int)
    dtype = np.result_type(*{values.dtype for _, values in parts})
    joined = np.zeros((count, *shape), dtype) if dtype.kind == "U" else np.full((count, *shape), np.nan)
    for rows, values in parts:
        joined[(rows, *map(slice, values.shape[1:]))] = values
    return joined
