"""What tells the cases of a scene apart beside their profiles: studies, and settings that are not the same for all.

They come from the scene alone, and no batch is solved again when a study gets another name.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from itertools import compress
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data.variables import LABEL
from weier.methods.registry import find_method
from weier.methods.settings import all_settings
from weier.scene.cases import Scene
from weier.scene.study import CaseProduct


def case_labels(scene: Scene) -> xr.Dataset:
    """Coordinates of all cases of a scene, in its order.

    `study` holds the names of the studies of each case, with commas between. `METHOD_SETTING`, such as `bem_points`,
    is there for each setting that differs between cases: NaN or an empty text where the method is not run, or the
    setting is left to the method.
    """
    columns: dict[str, NDArray[Any]] = {"study": np.array([", ".join(names) for names in scene.studies_of_cases])}
    meanings = {"study": "studies of the case"}
    for method in scene.layout.methods:
        run = [method in product.methods for product in scene.products]
        for setting, values in _settings(scene.products, method).items():
            if len(set(map(json.dumps, compress(values, run)))) > 1:
                columns[f"{method}_{setting}"] = _column(values)[scene.product_of_cases]
                meanings[f"{method}_{setting}"] = f"setting {setting} of method {method}"
    return xr.Dataset(
        coords={
            name: ("case", values, {"long_name": meanings[name], "units": "1", "coverage_content_type": LABEL})
            for name, values in columns.items()
        }
    )


def _settings(products: Sequence[CaseProduct], method: str) -> Mapping[str, list[Any]]:
    """The value of each setting of a method in the cases of each product; None where the method is not run."""
    solver = find_method(method)
    own = [all_settings(solver, each.settings.get(method, {})) if method in each.methods else {} for each in products]
    return {name: [settings.get(name) for settings in own] for name in all_settings(solver, {})}


def _column(values: list[Any]) -> NDArray[Any]:
    """Numbers with NaN, or texts with "", where there is None."""
    if any(isinstance(value, str | bool) for value in values):
        return np.array([_text(value) for value in values])
    return np.array([math.nan if value is None else value for value in values], float)


def _text(value: str | bool | None) -> str:
    return "" if value is None else value if isinstance(value, str) else json.dumps(value)
