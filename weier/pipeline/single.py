"""One profile without a scene file: what `weier solve` and `weier plot` do."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import yaml

from weier.data import dataset
from weier.data.dataset import Status
from weier.data.files import write_text
from weier.data.variables import VARIABLES
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.registry import find_method
from weier.methods.settings import checked_settings
from weier.pipeline.batch import solve_batch
from weier.pipeline.forecast import forecast
from weier.pipeline.progress import TERMINAL_SECONDS, waiting
from weier.scene import Case, Scene
from weier.scene.case import trace_parameters
from weier.theory.loads import check_range

PROFILE = tuple(
    name
    for name, entry in VARIABLES.items()
    if entry.dims in (("case",), ("case", "term")) and entry.dtype == "f8" and not entry.optional
)
WHY = {Status.not_applicable: "does not apply", Status.not_converged: "missed its tolerance"}


def solve_one(
    profile: Mapping[str, Any],
    loads: Array,
    methods: Sequence[str],
    settings: Mapping[str, Mapping[str, Any]],
) -> xr.Dataset:
    """The curves of one profile, as a dataset of one case with the seconds of each method.

    A method that has no curve is named on standard error, and raises if no other one has any.

    Parameters
    ----------
    profile : mapping
        D, gamma, m and phases or seed, as in a scene; or `trace`, what a scene says of one.
    loads : ndarray, shape (loads,)
        Mean pressures, in p_0*.
    methods : sequence of str
        As in `solve`.
    settings : mapping
        Of each method.
    """
    check_range(loads)
    foreign = [method for method in settings if method not in methods]
    if foreign:
        raise ValueError(
            f"settings were given for method {foreign[0]!r}, which is not run: run it, too, or give settings of "
            f"{', '.join(methods)} only"
        )
    checked = {method: checked_settings(find_method(method), settings.get(method, {})) for method in methods}
    case = Case(_parameters(profile), tuple(methods), {method: own for method, own in checked.items() if own})
    case.check_ranges()
    lines = forecast(case, loads)
    print(*lines, sep="\n", end="\n" * bool(lines), file=sys.stderr, flush=True)
    title = case.profile.describe() if "trace" in profile else f"Weierstrass profile, {case.profile.describe()}"
    scene = Scene(name="one", title=title, loads=loads, studies={}, batch_size=1, text=_text(title, case, loads))
    failures: list[str] = []
    with waiting(f"solving by {', '.join(methods)}") as show:
        data = solve_batch(scene, [case], done=show, failed=failures.append, pause=TERMINAL_SECONDS)
    if not (data["status"] == Status.solved).any():
        unconverged = (data["status"] == Status.not_converged).any()
        raise (ConvergenceError if unconverged else ValueError)("; ".join(failures))
    print(*failures, sep="\n", end="\n" * bool(failures), file=sys.stderr)
    return data.assign_attrs(title=title, scene=scene.text)


def write(data: xr.Dataset, path: Path) -> None:
    """Write the curves as netCDF or, where the name ends in .json or .csv, as such a text."""
    if path.suffix in TEXTS:
        write_text(path, TEXTS[path.suffix](data) + "\n")
    else:
        dataset.write(data, path, data.attrs["title"], "solved", data.attrs["scene"])


def as_csv(data: xr.Dataset) -> str:
    """The curves as comma-separated values, one row for each method and load; what is missing is empty."""
    return str(data.weier.table().to_csv(index=False)).rstrip("\n")


def as_json(data: xr.Dataset) -> str:
    """The curves of one case as JSON, by method; null stands for a missing number or minus infinity."""
    case = data.isel(case=0)
    parameters = {name: _plain(case[name].values) for name in PROFILE}
    parameters |= {str(name): case[name].item() for name in case.coords if str(name).startswith("trace")}
    curves = {method: _curves(case, method) for method in case["solution_method"].values.tolist()}
    loads = case["mean_pressure"].values.tolist()
    measured = {name: values for name, values in data.items() if values.dtype.kind == "f"}
    units = {str(name): values.attrs.get("normalised_by", values.attrs["units"]) for name, values in measured.items()}
    header = {"title": data.attrs["title"], "normalisation": dataset.NORMALISED, "units": units, **parameters}
    return json.dumps(header | {"mean_pressure": loads, "methods": curves}, indent=1, allow_nan=False)


def _curves(case: xr.Dataset, method: str) -> dict[str, Any]:
    """The variables of one method that have values, without those of the profile and those of other methods."""
    run, returned = case.sel(solution_method=method), {*find_method(method).returns, "seconds"}
    own = {
        str(name): _plain(values.values)
        for name, values in run.items()
        if (name in returned or not VARIABLES[str(name)].optional) and values.notnull().any()
        if (name not in PROFILE if values.dtype.kind == "f" else values.dims == ("mean_pressure",))
    }
    return own | {"settings": json.loads(str(run["settings"].values))}


def _plain(values: Array) -> Any:
    """Numbers and texts as JSON can hold them: it has no nan and no inf."""
    if values.dtype.kind == "U":
        return values.tolist()
    plain = values.astype(object)
    plain[~np.isfinite(values)] = None
    plain[np.isposinf(values)] = "inf"
    return plain.tolist()


def applicable(profile: Mapping[str, Any], methods: Sequence[str]) -> list[str]:
    """Those of some methods that apply to a profile; all of them where none does, so that they say why."""
    surface = Case(_parameters(profile), (), {}).profile
    return [method for method in methods if find_method(method).takes(surface)] or list(methods)


def _parameters(profile: Mapping[str, Any]) -> Mapping[str, Any]:
    """Those of a case, which has a digest of its heights."""
    return {"trace": trace_parameters(profile["trace"], Path())} if "trace" in profile else profile


def check_solved(data: xr.Dataset) -> None:
    """Refuse curves that lack one which was asked for."""
    numbers = zip(data["solution_method"].values.tolist(), data["status"].values[0].tolist(), strict=True)
    missing = [f"{method} {WHY[Status(number)]}" for method, number in numbers if number != Status.solved]
    if missing:
        raise ValueError(f"{', '.join(missing)}, as said above; the curves of the others are there")


def _text(title: str, case: Case, loads: Array) -> str:
    """A scene file that gives the same curves."""
    # Lists of phases are one to a profile in a scene.
    product = {name: [value] if name == "phases" else value for name, value in case.parameters.items()}
    trace = {name: value for name, value in case.parameters.get("trace", {}).items() if name != "digest"}
    scene = {"title": title, "loads": loads.tolist(), "methods": list(case.methods)}
    scene |= {"settings": {name: dict(values) for name, values in case.settings.items()}} if case.settings else {}
    return yaml.safe_dump(
        scene | {"studies": {"one": {"trace": trace} if trace else {"product": product}}}, sort_keys=False
    )


TEXTS = {".json": as_json, ".csv": as_csv}  # by the end of a file's name
