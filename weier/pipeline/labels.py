"""What tells the cases of a scene apart beside their profiles: studies, and settings that are not the same for all.

They come from the scene alone, and no batch is solved again when a study gets another name.
"""

from __future__ import annotations

import json
import math
from itertools import compress
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.data.variables import LABEL
from weier.methods.registry import find_method
from weier.methods.settings import all_settings, defaults
from weier.scene.cases import Scene


def case_labels(scene: Scene) -> xr.Dataset:
    """Coordinates of all cases of a scene, in its order.

    `study` holds the names of the studies of each case, with commas between. `METHOD_SETTING`, such as `bem_points`,
    is there for each setting that differs between cases: NaN or an empty text where the method is not run, or the
    setting is left to the method.
    """
    studies = np.array([", ".join(names) for names in scene.studies_of_cases])
    columns: dict[str, tuple[NDArray[Any], str]] = {"study": (studies, "studies of the case")}
    for name in scene.layout.methods:
        method, run = find_method(name), [name in product.methods for product in scene.products]
        own = [all_settings(method, product.settings.get(name, {})) for product in scene.products]
        for setting in defaults(method):
            values = [each[setting] for each in own]
            if len(set(map(json.dumps, compress(values, run)))) > 1:
                column = _column([value if ran else None for value, ran in zip(values, run, strict=True)])
                columns[f"{name}_{setting}"] = column[scene.product_of_cases], f"setting {setting} of method {name}"
    return xr.Dataset(
        coords={
            name: ("case", values, {"long_name": meaning, "units": "1", "coverage_content_type": LABEL})
            for name, (values, meaning) in columns.items()
        }
    )


def _column(values: list[Any]) -> NDArray[Any]:
    """Numbers with NaN, or texts with "", where there is None."""
    if any(isinstance(value, str | bool) for value in values):
        texts = [json.dumps(value) if isinstance(value, bool) else value for value in values]
        return np.array(["" if text is None else text for text in texts])
    return np.array([math.nan if value is None else value for value in values], float)
