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
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.data.files import replacing, write_text
from weier.kernels.arrays import Flags, Indices
from weier.pipeline.needed_curves import Kind, Part, each_once
from weier.scene.identity import Keys

Rows = tuple[Indices, Indices]  # the segment of each curve, and its row there

KEY, ORIGIN = "key", "origin"  # one key per row, one origin per segment
SUFFIX = ".npz"
DAMAGED = "{} is damaged: move it away and run snakemake again, which solves its curves anew"


class Index(NamedTuple):
    """The rows of a kind: segments with columns and origin, sorted keys, and the segment and the row of each key."""

    files: Sequence[Path]
    columns: Sequence[Collection[str]]
    origins: Sequence[str]
    keys: Keys
    segment: Indices
    row: Indices

    def find(self, keys: Keys) -> tuple[Flags, Indices]:
        """Return whether each key has a row, and its position in the index."""
        place = np.searchsorted(self.keys, keys)
        return np.append(self.keys, 0)[place] == keys if self.keys.size else np.zeros(keys.shape, bool), place


class Store:
    """The solved curves of one folder, such as results/curves, under one numerics."""

    def __init__(self, folder: str | Path, numerics: str) -> None:
        self.folder, self.numerics = Path(folder), numerics
        self._indices: dict[str, Index] = {}

    def lacking(self, wanted: Iterable[Part]) -> list[Part]:
        """Return the parts reduced to curves that the store lacks, each curve once."""
        lacking = (part.only(~self.index(part.kind.name).find(part.keys)[0]) for part in each_once(wanted))
        return [part for part in lacking if part.cases.size]

    def rows(self, kind: Kind, keys: Keys) -> Rows:
        """Return where curves are; ValueError if one is not solved."""
        index = self.index(kind.name)
        known, place = index.find(keys)
        if not known.all():
            raise ValueError(f"{(~known).sum()} curves by {kind.method} are not solved: run snakemake again")
        return index.segment[place], index.row[place]

    def read(self, kind: Kind, rows: Rows, name: str) -> NDArray[Any] | None:
        """Return a variable of the curves in `rows`, shape (rows, ...), NaN or "" if missing; None if none has it."""
        index, (segment, row) = self.index(kind.name), rows
        if name == ORIGIN:
            return np.array(index.origins, object)[segment]
        found: dict[int, NDArray[Any]] = {}
        for number in np.flatnonzero(np.bincount(segment)).tolist():  # those that have rows
            if name in index.columns[number]:
                with np.load(index.files[number]) as columns:
                    found[number] = columns[name]
        if not found:
            return None
        shape = np.max([values.shape[1:] for values in found.values()], axis=0).astype(int)
        joined = _blank((len(row), *shape), np.result_type(*{values.dtype for values in found.values()}))
        for number, values in found.items():
            here = segment == number
            within = tuple(map(slice, values.shape[1:]))
            joined[(here, *within)] = values[row[here]]
        return joined

    def append(self, kind: Kind, rows: Mapping[np.uint64, Mapping[str, Any]], origin: str) -> None:
        """Append curves as one segment, atomically: the data are synced to disk before the file gets its name."""
        if not (about := self.folder / kind.name / "kind.json").exists():
            write_text(about, json.dumps(kind.about, indent=1, sort_keys=True) + "\n")
        names = dict.fromkeys(name for row in rows.values() for name in row)
        columns = {name: _column([row.get(name) for row in rows.values()]) for name in names}
        columns |= {KEY: np.array([*rows], np.uint64), ORIGIN: np.array(origin)}
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
            names, origins, keys = list[Collection[str]](), [], []
            for file in files:
                content = file.read_bytes()
                if not file.stem.endswith(_checksum(content)):
                    raise ValueError(DAMAGED.format(file))
                with np.load(io.BytesIO(content)) as columns:
                    names.append(columns.files)
                    origins.append(str(columns[ORIGIN]))
                    keys.append(columns[KEY])
            every = np.concatenate([np.empty(0, np.uint64), *keys])
            order = np.argsort(every, kind="stable")
            sizes = [len(own) for own in keys]
            segment = np.repeat(np.arange(len(files)), sizes)
            row = np.concatenate([np.empty(0, int), *map(np.arange, sizes)])
            self._indices[kind] = Index(files, names, origins, every[order], segment[order], row[order])
        return self._indices[kind]


def _checksum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def _column(values: Sequence[Any]) -> NDArray[Any]:
    """Return values of rows as an array, shape (rows, ...): shorter ones end in NaN, missing ones are NaN or ""."""
    arrays = [np.asarray(value) for value in values if value is not None]
    shape = np.max([array.shape for array in arrays], axis=0).astype(int)
    column = _blank((len(values), *shape), np.result_type(*{array.dtype for array in arrays}))
    for row, value in enumerate(values):
        if value is not None:
            column[row, ...][tuple(map(slice, np.shape(value)))] = value
    return column


def _blank(shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return an array of values that are missing; integers become floats."""
    if dtype.kind == "U":
        return np.zeros(shape, dtype)
    return np.full(shape, np.nan)
