"""Selection of curves: `data.weier.cases` selects by D, gamma, m, seed and study, and `table` is a DataFrame.

Importing this module gives every `xarray.Dataset` the accessor `weier`.
"""

from __future__ import annotations

import json
from collections.abc import Hashable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from weier.checks import checked_number, shown
from weier.data import curves, ensembles
from weier.data.ensembles import CLOSE
from weier.data.variables import CURVE, VARIABLES
from weier.kernels.arrays import Flags
from weier.surface.profile import PARAMETERS, checked_ratio

if TYPE_CHECKING:
    import pandas as pd

# A dataset of curves has these variables.
NEEDED = (*PARAMETERS, "solution_method", "mean_pressure")


@xr.register_dataset_accessor("weier")
class CurvesAccessor:
    """The methods that `data.weier` adds to an `xarray.Dataset` of curves."""

    def __init__(self, data: xr.Dataset) -> None:
        self._data = data

    def cases(self, **labels: Any) -> xr.Dataset:
        """Return the cases that have the labels given.

        Parameters
        ----------
        **labels
            Coordinates of the cases, each with one value or a list: D, gamma, also as a Fraction or "5/2", m, also
            inf, the seed of random phases, the study of a scene, or the name of a trace.

        Returns
        -------
        Dataset
            Never empty: the dimension `case` stays, of size 1 where one case fits.

        Raises
        ------
        ValueError
            If no case has such a label: the message says which there are.

        Examples
        --------
        >>> import weier
        >>> with weier.open_dataset(path) as data:
        ...     data.weier.cases(D=1.25, m=2).compliance.sel(solution_method="demelio").values.round(4)
        array([[0.4044, 1.2805]])
        """
        data = as_cases(self._data)
        for name, wanted in labels.items():
            is_one = isinstance(wanted, str) or not np.iterable(wanted)
            data = data.isel(case=_having(data, name, [wanted] if is_one else list(wanted)))
        return data

    def table(self) -> pd.DataFrame:
        """Return the curves as a pandas.DataFrame, one row for each case, method and load that was solved.

        Returns
        -------
        DataFrame
            First the labels of the case, `solution_method` and `mean_pressure`, then all quantities with a value, and
            `contact_pressure`, the mean pressure of the contacts.

        Examples
        --------
        >>> import weier
        >>> table = weier.solve(weier.Profile(D=1.5, gamma=3, m=2), [0.1, 1.0], "demelio").weier.table()
        >>> table[["D", "gamma", "m", "phases", "mean_pressure", "compliance"]].round(4)
             D  gamma    m      phases  mean_pressure  compliance
        0  1.5    3.0  2.0  [0.0, 0.0]            0.1      0.4587
        1  1.5    3.0  2.0  [0.0, 0.0]            1.0      1.5164
        """
        data = curves.with_contact_pressure(as_cases(self._data))
        quantities = [name for name, values in data.data_vars.items() if values.dims == CURVE]
        rows = data[quantities]
        if "phases" in data.coords:
            phases = [json.dumps(row[np.isfinite(row)].tolist()) for row in data["phases"].values]
            rows = rows.assign_coords(phases=("case", phases))
        frame = rows.to_dataframe(CURVE).reset_index()[[*_labels(rows), *CURVE[1:], *quantities]]
        frame = frame.dropna(how="all", subset=quantities)
        return frame.dropna(axis="columns", how="all").reset_index(drop=True)

    def ensemble(self) -> pd.DataFrame:
        """Return the mean curves of each ensemble with their scatter and numerical error, as a DataFrame.

        The cases of an ensemble belong to one study and differ in their phases, seed or file of heights alone: series
        have the same D, gamma and m; traces the same ends, removed form and `shortest`, within 1 %; random lines also
        the same Hurst exponent, roll-off, length and height. A surface that a list or a scene gives twice, by the
        same seed or phases, counts once.

        Returns
        -------
        DataFrame
            One row for each ensemble, method and load: the labels of the ensemble; the number of `cases`, surfaces
            that were solved there; and for the compliance, the resistance and, where there is one, the contact
            fraction and the mean pressure of the contacts, `contact_pressure`, the mean over these cases, `..._mean`;
            the standard deviation between them, `..._deviation`; the median and the percentiles, `..._median`,
            `..._percentile_10` and `..._percentile_90`, interpolated linearly between cases; and the largest error
            that a method states, `..._numerical_error`.

        Raises
        ------
        ValueError
            If the cases of an ensemble are traces in units of their own height and length, or do not have common
            pressures: `weier.Interface.solve` takes a list of traces and pressures in Pa.

        Examples
        --------
        >>> import weier
        >>> series = [weier.Profile(D=1.5, gamma=3, m=m, seed=seed) for m in (1, 2) for seed in range(8)]
        >>> table = weier.solve(series, [0.1]).weier.ensemble()
        >>> table[["D", "m", "mean_pressure", "cases", "compliance_mean"]].round(2)
             D    m  mean_pressure  cases  compliance_mean
        0  1.5  1.0            0.1      8             0.33
        1  1.5  2.0            0.1      8             0.63
        """
        return ensembles.means(curves.with_contact_pressure(as_cases(self._data)))


def as_cases(data: xr.Dataset) -> xr.Dataset:
    """Return curves with the dimensions of the table of variables, in its order, whatever was selected from them.

    A dimension that was selected away is added with size 1. ValueError is raised if a variable that describes a curve
    is missing, and by xarray if dimensions were stacked.
    """
    if lacking := [name for name in NEEDED if name not in data.variables]:
        raise ValueError(
            f"the dataset holds no curves, since there is no {lacking[0]}: take a result of weier.solve, or a file "
            "of curves"
        )
    changed = dict[Hashable, xr.Variable]()
    for label, variable in data.variables.items():
        known = VARIABLES.get(str(label))
        dims: tuple[Hashable, ...] = known.dims if known else variable.dims or ("case",)
        if variable.dims != dims:
            changed[label] = variable.set_dims({dim: data.sizes.get(dim, 1) for dim in dims})
    # A coordinate that becomes a dimension needs a new index.
    kept = {label: variable for label, variable in data.variables.items() if label not in changed}
    return xr.Dataset(kept | changed, attrs=data.attrs).set_coords(list(data.coords))


def name_cases(data: xr.Dataset) -> xr.Dataset:
    """Return the curves with a name for each case, of study, D, gamma, m, seed or phases.

    A trace is named by its file and its digest, which determine all else.
    """
    order = ("study", "trace", *PARAMETERS, "seed", "phases", "trace_digest")
    columns = {name: map(label_text, data[name].values) for name in order if name in data.coords}
    names = []
    for texts in zip(*columns.values(), strict=True):
        labels = {name: text for name, text in zip(columns, texts, strict=True) if text}
        study = [labels.pop("study")] if "study" in labels else []
        listed = [f"{name} = {text}" for name, text in labels.items() if name != "phases" or "seed" not in labels]
        names.append(": ".join([*study, ", ".join(listed)]))
    return data.assign_coords(case=("case", np.array(names, object), {"long_name": "case"}))


def _labels(data: xr.Dataset) -> list[str]:
    """Return the names of the coordinates with one value per case."""
    return [str(name) for name in data.coords if data[name].dims == ("case",) and name != "case"]


def label_text(value: Any) -> str:
    """Return a label as text, empty if it is missing; phases are one number if all terms but the first have it."""
    if np.ndim(value):
        known = value[np.isfinite(value)]
        alike = known.size < 2 or (known[0] == 0 and np.ptp(known[1:]) == 0)
        return ", ".join(f"{phase:.4g}" for phase in (known[-1:] if alike else known))
    if isinstance(value, float):
        # All digits of a whole number, since seeds may differ in the last one.
        return "" if np.isnan(value) else f"{value:.{16 if value.is_integer() else 6}g}"
    return str(value)


def _having(data: xr.Dataset, name: str, wanted: list[Any]) -> Flags:
    """Return whether each case matches one of the values; `study` may hold several names, separated by commas."""
    if name not in (known := _labels(data)):
        raise ValueError(f"there is no label {name!r} of cases: select by {', '.join(known)}")
    labels = data[name].values
    if labels.dtype.kind in "UOT":
        own = [str(label).split(", ") if name == "study" else [str(label)] for label in labels]
        fits = np.array([[word in names for word in wanted] for names in own])
        labels = np.array([text for names in own for text in names])
    else:
        convert = checked_ratio if name == "gamma" else partial(checked_number, name)
        numbers = np.array([float(convert(value)) for value in wanted])
        fits = np.isclose(labels[:, None], numbers, rtol=0 if name == "seed" else CLOSE, atol=0)
    absent = [shown(value) for value, column in zip(wanted, fits.T, strict=True) if not column.any()]
    if absent or not wanted:
        texts = [text for value in np.unique(labels) if (text := label_text(value))] or ["none"]
        raise ValueError(f"no case has {name} = {(absent or ['[]'])[0]}: choose from {', '.join(texts):.200}")
    return np.asarray(fits.any(axis=1))
