"""Incomplete files of `weier solve`: check that they match the request, and read their curves."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from weier.api.task import Known
from weier.data import dataset
from weier.data.si import INTERFACE_ATTRIBUTES
from weier.data.variables import LOADS, VARIABLES
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES, Curve
from weier.methods.registry import find_method
from weier.methods.settings import all_settings
from weier.pipeline.single import code, scene_text, surface_key
from weier.scene.case import Case
from weier.scene.yaml import parse_yaml

if TYPE_CHECKING:
    import xarray as xr

    from weier.data.bodies import Bodies

OTHERWISE = "name another file, or solve anew by --force"


def read(path: Path, case: Case, bodies: Bodies | None) -> tuple[Array, dict[str, Known]]:
    """Return the loads of a file of `weier solve`, in p_0*, and the curves that it has, by method.

    Parameters
    ----------
    path : path
        The file.
    case : Case
        The requested surface, methods and settings.
    bodies : Bodies, optional
        Both bodies with the scale of the surface; the file is then in SI units.

    Raises
    ------
    ValueError
        If the file holds another problem or comes from other code; the message names the difference.
    """
    try:
        data = dataset.read(path)
    except ValueError:
        raise ValueError(f"{path} exists, and is no file of weier: {OTHERWISE}") from None
    if "numerics" not in data.attrs:
        raise ValueError(f"{path} exists, and is not of `weier solve`: {OTHERWISE}")
    theirs, ours = data.attrs["numerics"], code()
    if not (theirs and ours):
        raise ValueError(f"{path} exists, and whether this code solved it is unknown without sources: {OTHERWISE}")
    if theirs != ours:
        raise ValueError(f"{path} exists, and is solved by other code ({theirs}, not {ours}): {OTHERWISE}")
    scene, wanted = parse_yaml(data.attrs["scene"]), parse_yaml(scene_text(case, np.empty(0)))
    loads, settings = np.array(scene["loads"], float), _settings(wanted)
    own = {} if bodies is None else {name: value for name, value in vars(bodies).items() if value is not None}
    differences = {
        "another surface": _differing(_surface(scene), _surface(wanted)) or ("heights", "others"),
        "other methods": _differing(_settings(scene), settings),
        "other bodies": _differing(
            {name: data.attrs[name] for name in INTERFACE_ATTRIBUTES if name in data.attrs}, own
        ),
    }
    if data["surface_key"].values[0] == surface_key(case):  # the spelling of a value does not matter
        del differences["another surface"]
    for what, pair in differences.items():
        if pair:
            raise ValueError("{} exists, of {}: {}, not {}: {}".format(path, what, *pair, OTHERWISE))
    pressures, methods = data["mean_pressure"].values, data["solution_method"].values.tolist()
    whole = pressures.size == loads.size and np.allclose(pressures * loads[-1], loads * pressures[-1], 1e-12, 0.0)
    if not whole or {*methods} != {*settings}:
        raise ValueError(f"{path} exists, and was changed since it was solved: {OTHERWISE}")
    scales = _scales(bodies)
    known = {
        method: _known(data.isel(case=0).sel(solution_method=method), loads, scales)
        for method in continued(case, bodies)
    }
    return loads, {method: one for method, one in known.items() if one.loads.size}


def continued(case: Case, bodies: Bodies | None) -> list[str]:
    """Return the methods whose curves go on from a file: those that solve each load by itself.

    There are none in SI units between perfect conductors, since these leave no R to convert back.
    """
    settings = _settings(parse_yaml(scene_text(case, np.empty(0))))
    convertible = all(_scales(bodies).values())
    return [method for method, given in settings.items() if convertible and find_method(method).by_load(**given)]


def _scales(bodies: Bodies | None) -> dict[str, float]:
    """Return the value of each normalised unit in SI units; nothing without bodies."""
    return {} if bodies is None else {unit: float(value) for unit, (value, _) in bodies.scales.items()}


def _known(run: xr.Dataset, loads: Array, scales: Mapping[str, float]) -> Known:
    """Return the curve of a file by one method at the loads that are solved, in normalised units."""
    solved, values = np.isfinite(run["compliance"].values), dict[str, Any]()
    for name in (*QUANTITIES, *find_method(str(run["solution_method"].values)).returns):
        if name not in run.data_vars:
            continue
        found = run[name].values
        if LOADS in run[name].dims:
            values[name] = found[solved] / scales.get(VARIABLES[name].unit, 1.0)
        elif found.dtype.kind in "UO" or np.isfinite(found):
            values[name] = found.item()
    return Known(loads[solved], Curve(**values), float(run["seconds"]) if "seconds" in run else np.nan)


def _surface(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the only surface of a scene."""
    ((_, parameters),) = scene["studies"]["one"].items()
    return dict(parameters)


def _settings(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return all settings of each method of a scene."""
    given = scene.get("settings", {})
    return {name: all_settings(find_method(name), given.get(name, {})) for name in scene["methods"]}


def _short(value: Any) -> Any:
    """Return a number without the digits of rounding."""
    return f"{value:.12g}" if isinstance(value, float) else value


def _differing(*given: Mapping[str, Any]) -> tuple[str, ...]:
    """Describe the values in which two mappings differ; return nothing if they are equal."""
    names = [name for name in {**given[0], **given[1]} if given[0].get(name) != given[1].get(name)]
    both = (", ".join(f"{name} = {_short(one[name])}" for name in names if name in one) or "none" for one in given)
    return tuple(both) if names else ()
