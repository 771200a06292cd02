"""A file of curves, from which cases are selected by D, gamma, m, phases, method of solution and mean pressure."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from weier.data import dataset
from weier.kernels.arrays import Array
from weier.theory.arguments import checked_number, checked_numbers, checked_word, shown
from weier.theory.profile import checked_ratio
from weier.theory.tables import html_table

CLOSE = 1e-9  # relative: 0.1 typed is 0.1 stored, whatever arithmetic it came from
MAX_VALUES_IN_MESSAGE = 10  # values that a message lists

Ratio = int | float | str | Fraction


@dataclass(frozen=True)
class Contact:
    """Curves over case, solution_method and mean_pressure, read from the file where they are asked for.

    Its `sel` also selects cases by what describes them (D, gamma, m, phases), which are no index of an xarray
    Dataset, and takes gamma as a fraction. What it selects is a Contact again; `data` is the xarray Dataset, and
    `contact["compliance"]` a DataArray. Close the file with `close`, or open it in a `with` statement.

    Examples
    --------
    >>> import weier
    >>> with weier.open(path) as contact:
    ...     one = contact.sel(m=2, solution_method="demelio")
    ...     print(one["compliance"].dims, one.data.sizes["mean_pressure"])
    ('case', 'mean_pressure') 2
    """

    data: xr.Dataset

    def __post_init__(self) -> None:
        if not isinstance(self.data, xr.Dataset):
            raise ValueError(f"data must be an xarray.Dataset, got {shown(self.data)}; weier.open reads one")

    def sel(
        self,
        *,
        D: ArrayLike | None = None,
        gamma: Ratio | Sequence[Ratio] | None = None,
        m: ArrayLike | None = None,
        phases: ArrayLike | None = None,
        seed: ArrayLike | None = None,
        study: str | None = None,
        solution_method: str | Sequence[str] | None = None,
        mean_pressure: ArrayLike | None = None,
        **settings: Any,
    ) -> Contact:
        """Those cases, methods and loads that have the labels given.

        Parameters
        ----------
        D, gamma, m : number or list of numbers
            Of the cases; gamma also as a Fraction or "5/2", m also inf.
        phases : number or list of m numbers
            In radians: of every term but the first, which then has phase 0; or of each term. Also by the name of the
            coordinate that holds them, `phase`.
        seed : int or list of int
            Of random phases.
        study : str
            A study of the scene.
        solution_method : str or list of str
            One name leaves no dimension `solution_method`, a list keeps it.
        mean_pressure : number or list of numbers
            Loads of the file, in p_0*. One number leaves no dimension `mean_pressure`.
        **settings
            Any other coordinate of the cases, such as `bem_points`: a setting that differs between them.

        Returns
        -------
        Contact
            Never empty: the dimension `case` stays, of size 1 where one case fits.

        Raises
        ------
        ValueError
            If nothing has such a label: the message says what is there.

        """
        data = self.data
        ratios = None if gamma is None else [float(checked_ratio(value)) for value in _list("gamma", gamma)]
        for name, wanted in (("D", D), ("gamma", ratios), ("m", m), ("seed", seed)):
            if wanted is not None:
                data = _with_parameter(data, name, _numbers(name, _list(name, wanted)))
        for wanted in (phases, settings.pop("phase", None)):
            if wanted is not None:
                data = _with_phases(data, checked_numbers("phases", wanted, "be finite", np.isfinite))
        for name, wanted in {"study": study, **settings}.items():
            if wanted is not None:
                data = _with_label(data, name, wanted)
        for name, labels in (("solution_method", solution_method), ("mean_pressure", mean_pressure)):
            if labels is not None:
                data = data.isel({name: _rows(data, name, labels)})
        return Contact(data)

    def __getitem__(self, name: str) -> xr.DataArray:
        return self.data[name]

    def _repr_html_(self) -> str:
        """What the file holds, for notebooks: its cases in a table, then the dataset."""
        if "case" not in self.data.sizes:
            return str(self.data._repr_html_())
        columns = [self.data[name].values.tolist() for name in ("D", "gamma", "m")]
        series = Counter(zip(*columns, strict=True))
        rows = [[*(f"{value:.6g}" for value in values), str(count)] for values, count in series.items()]
        header = ["D", "gamma", "m", "cases"]
        return html_table(str(self.data.attrs.get("title", "")), header, rows) + self.data._repr_html_()

    def close(self) -> None:
        """Close the file."""
        self.data.close()

    def __enter__(self) -> Contact:
        return self

    def __exit__(self, *failure: object) -> None:
        self.close()


def open(path: str | Path) -> Contact:
    """Open a netCDF file of the pipeline, or of a result of `weier.solve`: values are read where they are needed.

    Parameters
    ----------
    path : path
        Such as results/paper/contact.nc.

    Returns
    -------
    Contact
        Its `sel` selects by D, gamma, m, phases, solution_method and mean_pressure; its `data` is the xarray Dataset.

    Raises
    ------
    ValueError
        If the file is missing, cut short, or not of weier.

    Examples
    --------
    >>> import weier
    >>> with weier.open(path) as contact:
    ...     one = contact.sel(D=1.25, m=2, solution_method="demelio", mean_pressure=0.1)
    ...     print(one["compliance"].values.round(4))
    [0.4044]

    """
    if not isinstance(path, str | PathLike):
        raise ValueError(f"path must be the name of a file, got {shown(path)}")
    return Contact(dataset.as_cases(dataset.open_lazily(path)))


def _list(name: str, wanted: Any) -> list[Any]:
    """What was asked for as a list; an empty one asks for nothing, and would be given nothing."""
    listed = isinstance(wanted, list | tuple) or (hasattr(wanted, "__array__") and np.ndim(wanted) > 0)
    if listed and len(wanted) == 0:
        raise ValueError(f"{name} must have a value to select by, got an empty list")
    return list(wanted) if listed else [wanted]


def _numbers(name: str, wanted: Any) -> Array:
    """The numbers asked for, shape (numbers,)."""
    return np.array([checked_number(name, value, "be a number", lambda value: value == value) for value in wanted])


def _with_parameter(data: xr.Dataset, name: str, wanted: NDArray[np.float64]) -> xr.Dataset:
    values = data[name].values
    # Equal first: inf is close to nothing.
    fits = (values[:, None] == wanted) | np.isclose(values[:, None], wanted, rtol=CLOSE, atol=0)
    if not fits.any(axis=0).all():
        absent = wanted[np.argmin(fits.any(axis=0))]
        raise ValueError(f"no case has {name} = {absent:g}: choose from {_some(np.unique(values))}")
    return data.isel(case=np.flatnonzero(fits.any(axis=1)))


def _with_label(data: xr.Dataset, name: str, wanted: Any) -> xr.Dataset:
    """The cases with a label of those that not every file has; a text may be one of several with commas between."""
    known = [str(each) for each in data.coords if data[each].dims == ("case",)]
    if name not in known:
        others = ["phases", *({"solution_method", "mean_pressure"} & set(map(str, data.dims)))]
        raise ValueError(f"there is no label {name!r}: select by {', '.join([*known, *sorted(others)])}")
    labels = data[name].values
    if labels.dtype.kind == "f":
        return _with_parameter(data, name, _numbers(name, _list(name, wanted)))
    texts = [json.dumps(each) if isinstance(each, bool) else each for each in _list(name, wanted)]
    fits = [any(text in str(label).split(", ") for text in texts) for label in labels.tolist()]
    if not any(fits):
        raise ValueError(f"no case has {name} = {shown(wanted)}: choose from {_some(np.unique(labels.astype(str)))}")
    return data.isel(case=np.flatnonzero(fits))


def _with_phases(data: xr.Dataset, wanted: NDArray[np.float64]) -> xr.Dataset:
    phase = data["phase"].values
    if wanted.ndim > 1 or wanted.size == 0:
        raise ValueError(f"phases must be a number or a list of numbers, got {shown(wanted)}")
    expected = np.where(np.arange(phase.shape[1]) == 0, 0.0, wanted) if wanted.ndim == 0 else wanted
    if expected.shape != (min(expected.size, phase.shape[1]),):
        raise ValueError(f"phases must be a number or at most {phase.shape[1]} numbers, got {expected.size}")
    first, rest = phase[:, : expected.size], np.isfinite(phase[:, expected.size :])
    near = np.isclose(first, expected, rtol=CLOSE, atol=CLOSE)
    if wanted.ndim == 0:
        near |= np.isnan(first)  # a number is the phase of as many terms as there are
    infinite = np.isinf(data["m"].values)  # has no phases
    fits = infinite | (near.all(axis=1) & ~rest.any(axis=1))
    if not fits.any():
        raise ValueError(f"no case has phases = {wanted.tolist()}: they are in the coordinate phase(case, term)")
    return data.isel(case=np.flatnonzero(fits))


def _rows(data: xr.Dataset, name: str, wanted: Any) -> int | list[int]:
    """The positions of the labels that are asked for along a dimension: one, or a list where a list is asked for."""
    labels, listed = data[name].values, _list(name, wanted)
    values = listed if labels.dtype.kind in "OU" else _numbers(name, listed).tolist()
    rows = [_row(labels, value, name) for value in values]
    return rows if np.ndim(wanted) else rows[0]


def _row(labels: NDArray[Any], label: Any, name: str) -> int:
    if labels.dtype.kind in "OU":
        return labels.tolist().index(checked_word(name, label, labels.tolist()))
    same = np.isclose(labels, label, rtol=CLOSE, atol=0)
    if not same.any():
        raise ValueError(f"there is no {name} {label!r}: choose from {_some(labels)}")
    return int(np.argmax(same))


def _some(values: NDArray[Any]) -> str:
    texts = [f"{value:.6g}" if isinstance(value, float) else str(value) for value in values.tolist()]
    return ", ".join(texts[:MAX_VALUES_IN_MESSAGE]) + (", ..." if len(texts) > MAX_VALUES_IN_MESSAGE else "")
