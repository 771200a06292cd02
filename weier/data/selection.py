"""Selection of curves: `data.weier.cases` selects by D, gamma, m, phases and study, and `table` is a DataFrame.

Importing this module gives every `xarray.Dataset` the accessor `weier`.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from weier import units
from weier.checks import checked_number, checked_numbers, shown
from weier.data.variables import CURVE, VARIABLES
from weier.kernels.arrays import Flags
from weier.surface.profile import PARAMETERS, Profile, checked_ratio
from weier.theory.conduction import LOAD, LOADS

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]  # its stubs are a package more

CLOSE = 1e-9  # Labels that differ by less, relative, are equal, so that a typed 0.1 matches a computed one.
MAX_VALUES_IN_MESSAGE = 10  # A message lists at most so many values, to stay short.
# A dataset of curves has these variables.
NEEDED = (*PARAMETERS, "phases", "solution_method", "mean_pressure")

Ratio = int | float | str | Fraction


@xr.register_dataset_accessor("weier")  # type: ignore[no-untyped-call]  # of xarray
class CurvesAccessor:
    """The methods that `data.weier` adds to an `xarray.Dataset` of curves."""

    def __init__(self, data: xr.Dataset) -> None:
        self._data = data

    def cases(
        self,
        *,
        D: ArrayLike | None = None,
        gamma: Ratio | Sequence[Ratio] | None = None,
        m: ArrayLike | None = None,
        phases: ArrayLike | None = None,
        seed: ArrayLike | None = None,
        study: str | Sequence[str] | None = None,
        **settings: Any,
    ) -> xr.Dataset:
        """The cases that have the labels given.

        Parameters
        ----------
        D, gamma, m : number or list of numbers
            Gamma also as a Fraction or "5/2", m also inf.
        phases : number or list of m numbers
            In radians: of every term but the first, which then has phase 0; or of each term.
        seed : int or list of int
            Of random phases.
        study : str or list of str
            Studies of the scene.
        **settings
            Any other coordinate of the cases, such as `bem_points`: a setting that differs between them.

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
        for name, wanted in {"D": D, "gamma": gamma, "m": m, "seed": seed, "study": study, **settings}.items():
            if wanted is not None:
                data = data.isel(case=np.flatnonzero(_having(data, name, _list(name, wanted))))
        if phases is None:
            return data
        return data.isel(case=np.flatnonzero(_having_phases(data, phases)))

    def table(self) -> pd.DataFrame:
        """The curves as a pandas.DataFrame, one row for each case, method and load that was solved.

        Returns
        -------
        DataFrame
            First the labels of the case, `solution_method` and `mean_pressure`, then all quantities with a value.

        Examples
        --------
        >>> import weier
        >>> table = weier.solve(weier.Profile(D=1.5, gamma=3, m=2), [0.1, 1.0], "demelio").weier.table()
        >>> table[["D", "gamma", "m", "phases", "mean_pressure", "compliance"]].round(4)
             D  gamma    m      phases  mean_pressure  compliance
        0  1.5    3.0  2.0  [0.0, 0.0]            0.1      0.4587
        1  1.5    3.0  2.0  [0.0, 0.0]            1.0      1.5164
        """
        data = as_cases(self._data)
        curve = curve_dims(data)
        phases = [json.dumps(row[np.isfinite(row)].tolist()) for row in data["phases"].values]
        labels = [name for name in _labels(data) if name != "case"]
        quantities = [name for name, values in data.data_vars.items() if values.dims == curve]
        rows = data[quantities].drop_vars("phases", errors="ignore")
        frame = rows.assign_coords(phases=("case", phases)).to_dataframe(dim_order=curve).reset_index()
        frame = frame.dropna(how="all", subset=quantities)[[*labels, "phases", *CURVE[1:], *quantities]]
        return frame.dropna(axis="columns", how="all").reset_index(drop=True)


def as_cases(data: xr.Dataset) -> xr.Dataset:
    """Curves over case, solution_method and mean_pressure; missing dimensions are added with size 1.

    Raises
    ------
    ValueError
        If a variable that describes a curve is missing or has the wrong type.
    """
    for name in NEEDED:
        kind = data.variables[name].dtype.kind if name in data.variables else "nothing"
        if kind not in ("UOT" if VARIABLES[name].dtype.startswith("U") else "fiu"):
            raise ValueError(
                f"the dataset holds no curves, since there is {'no' if kind == 'nothing' else 'a damaged'} {name}: "
                "take a result of weier.solve, or a file of curves"
            )
    for dim in reversed(curve_dims(data)):
        if dim not in data.dims:
            values = {name: _along(dim, str(name), variable) for name, variable in data.variables.items()}
            data = xr.Dataset(values, attrs=data.attrs).set_coords(list(data.coords))
    return data


def curve_dims(data: xr.Dataset) -> tuple[str, ...]:
    """The dimensions of curves; over LOAD in place of mean_pressure if the loads depend on the case."""
    return tuple(LOAD if dim == LOADS and LOAD in data.dims else dim for dim in CURVE)


def _along(dim: str, name: str, variable: xr.Variable) -> xr.Variable:
    """A variable with the dimension added, if the table has it; labels outside the table have the dimension case."""
    dims = VARIABLES[name].dims if name in VARIABLES else ("case",) if variable.ndim == 0 else ()
    if dim not in dims:
        return variable
    return xr.Variable((dim, *variable.dims), variable.values[None], variable.attrs)


def profile_of(data: xr.Dataset) -> Profile:
    """The profile of one curve, or of one case of a file.

    Parameters
    ----------
    data : Dataset
        A result of `weier.solve`, or one case of `weier.open_dataset`, with coordinates D, gamma, m, seed and phases.

    Returns
    -------
    Profile
        With phases in radians.

    Raises
    ------
    ValueError
        If there are several cases, or the curve is of a trace, whose heights are in their own file.

    Examples
    --------
    >>> import weier
    >>> curve = weier.solve(weier.Profile(D=1.5, gamma="5/2", m=2, phases=1.0), [0.1, 1.0], "demelio")
    >>> weier.profile_of(curve)
    Profile(D=1.5, gamma=Fraction(5, 2), m=2, phases=(0.0, 1.0))
    """
    if not hasattr(data, "data_vars"):
        raise ValueError(f"data must be a Dataset of curves, got {shown(data)}")
    cases = as_cases(data)
    if cases.sizes["case"] != 1:
        raise ValueError(f"data must have one case, got {cases.sizes['case']}: select it by data.isel(case=[0])")
    case = cases.isel(case=0)
    if np.isnan(case["D"]):
        raise ValueError("the curve is of a trace, which has no D: read its heights again by weier.Trace.read")
    m, seed = float(case["m"]), float(case.coords.get("seed", np.nan))
    phases = case["phases"].values[: int(m) if np.isfinite(m) else 2]
    given: dict[str, Any] = {"phases": tuple(phases.tolist()) if np.isfinite(m) else float(phases[-1])}
    if np.isfinite(seed):
        given = {"seed": int(seed)}
    return Profile(float(case["D"]), float(case["gamma"]), m, **given)


def name_cases(data: xr.Dataset) -> xr.Dataset:
    """The curves with a name for each case."""
    return data.assign_coords(case=("case", np.array(case_names(data), object), {"long_name": "case"}))


def case_names(data: xr.Dataset, but: Collection[str] = ()) -> list[str]:
    """A name for each case: its study, D, gamma, m, seed or phases, and settings that differ, except labels in `but`.

    A trace is named by its file and its digest, which determine all else.
    """
    first = ("study", "trace", *PARAMETERS, "seed", "phases", "trace_digest")
    others = [name for name in _labels(data) if name not in ("key", "case", *first) and not name.startswith("trace_")]
    order = [name for name in (*first, *others) if name in data.coords and name not in but]
    columns = {name: [label_text(value) for value in data[name].values] for name in order}
    return [_case_name({name: texts[row] for name, texts in columns.items()}) for row in range(data.sizes["case"])]


def _labels(data: xr.Dataset) -> list[str]:
    """The names of the coordinates that every case has one value of."""
    return [str(name) for name in data.coords if data[name].dims == ("case",)]


def _case_name(labels: Mapping[str, str]) -> str:
    own = [
        f"{name} = {text}"
        for name, text in labels.items()
        if text and name != "study" and not (name == "phases" and labels.get("seed"))
    ]
    return ": ".join(filter(None, (labels.get("study"), ", ".join(own))))


def label_text(value: Any) -> str:
    """A label as text, empty if it is missing; phases are one number if all terms but the first have it."""
    if np.ndim(value):
        known = value[np.isfinite(value)]
        alike = known.size < 2 or (known[0] == 0 and np.ptp(known[1:]) == 0)
        return ", ".join(f"{phase:.4g}" for phase in (known[-1:] if alike else known))
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.6g}"
    return str(value)


def _list(name: str, wanted: Any) -> list[Any]:
    """The wanted values as a list; ValueError if it is empty, since it would select nothing."""
    listed = isinstance(wanted, list | tuple) or bool(getattr(wanted, "shape", ()))  # an array of any library
    if listed and len(wanted) == 0:
        raise ValueError(f"{name} must have a value to select by, got an empty list")
    return list(wanted) if listed else [wanted]


def _having(data: xr.Dataset, name: str, wanted: list[Any]) -> Flags:
    """Whether each case has one of the wanted values; a text label may hold several, separated by commas."""
    known = [label for label in _labels(data) if label != "case"]
    if name not in known:
        raise ValueError(f"there is no label {name!r} of cases: select by {', '.join([*known, 'phases'])}")
    labels = data[name].values
    if labels.dtype.kind in "UOT":
        texts = [json.dumps(value) if isinstance(value, bool) else value for value in wanted]
        fits = np.array([[text in str(label).split(", ") for text in texts] for label in labels])
    else:
        numbers = np.array([_number(name, value, units.unit_of(data[name]) or units.NONE) for value in wanted])
        # Equality is tested as well, for inf.
        fits = (labels[:, None] == numbers) | np.isclose(labels[:, None], numbers, rtol=CLOSE, atol=0)
    if not fits.any(axis=0).all():
        absent = wanted[int(np.argmin(fits.any(axis=0)))]
        raise ValueError(f"no case has {name} = {shown(absent)}: choose from {_some(labels)}")
    return np.asarray(fits.any(axis=1))


def _number(name: str, value: Any, unit: str) -> float:
    if name == "gamma":
        return float(checked_ratio(value))
    return checked_number(name, value, "be a number", lambda number: number == number, unit)


def _having_phases(data: xr.Dataset, wanted: ArrayLike) -> Flags:
    """Whether each case has these phases: of every term but the first, or of each; an infinite series has any."""
    given = checked_numbers("phases", wanted, "be finite", np.isfinite, units.RADIAN)
    if given.ndim > 1 or given.size == 0:
        raise ValueError(f"phases must be a number or a list of numbers, got {shown(wanted)}")
    phases = data["phases"].values
    terms = phases.shape[1]
    if given.ndim == 0:
        expected = np.where(np.arange(terms) == 0, 0, given)
    elif given.size > terms:
        raise ValueError(f"phases must be a number or at most {terms} numbers, got {given.size}")
    else:
        expected = np.pad(given, (0, terms - given.size), constant_values=np.nan)
    near = np.isclose(phases, expected, rtol=CLOSE, atol=CLOSE, equal_nan=True)
    # A single number is the phase of all terms that a case has.
    fits: Flags = (near | (np.isnan(phases) & (given.ndim == 0))).all(axis=1) | np.isinf(data["m"].values)
    if not fits.any():
        raise ValueError(f"no case has phases = {given.tolist()}: they are in the coordinate phases(case, term)")
    return fits


def _some(values: NDArray[Any]) -> str:
    """The distinct values of a label; a text may hold several, separated by commas."""
    if values.dtype.kind in "UOT":
        values = np.array([part for text in values for part in str(text).split(", ")])
    texts = [text for value in np.unique(values) if (text := label_text(value))] or ["none"]
    return ", ".join(texts[:MAX_VALUES_IN_MESSAGE]) + (", ..." if len(texts) > MAX_VALUES_IN_MESSAGE else "")
