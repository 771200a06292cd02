"""Variants of methods run on cases, in one dataset."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from weier.accuracy.variants import Variant
from weier.api.batch import arrays, describe_case
from weier.data import dataset, variables
from weier.data.variables import LABEL, Variable
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES
from weier.scene import Case

DESCRIPTION = ("total_amplitude", "tail_amplitude", "first_contact")  # describe a case, with its coordinates
# variables that all comparisons have
KEPT = (*DESCRIPTION, *QUANTITIES, "compliance_error", "compliance_deviation", "points", "settings")
VARIANT = Variable(("variant",), "method and settings that are compared", content=LABEL)


class Comparison(NamedTuple):
    """A profile and the variants that are run on it.

    name : in a few words
    case : the profile, by the parameters of a scene
    loads : mean pressures, shape (loads,), increasing, in p_0*
    variants : the methods and settings
    """

    name: str
    case: Case
    loads: Array
    variants: tuple[Variant, ...]


Measure = Callable[[Comparison, Variant], Mapping[str, Any]]


def blank(comparisons: Sequence[Comparison], kept: Collection[str], own: Mapping[str, Variable]) -> xr.Dataset:
    """Return an empty dataset for the comparisons.

    It is like that of a scene, with variants instead of methods; the coordinate solution_method has their methods.
    `kept` names variables of the common table; `own` are further ones, with the dimension solution_method for
    variants, as in that table.
    """
    # Distinct variants by name, in the order of the longest comparison.
    lists = sorted((comparison.variants for comparison in comparisons), key=len, reverse=True)
    variants = {variant.name: variant for own in lists for variant in own}
    methods = [variant.method for variant in variants.values()]
    loads = np.unique(np.concatenate([comparison.loads for comparison in comparisons]))
    terms = max(np.size(comparison.case.profile.listed_phases) for comparison in comparisons)
    data = dataset.blank(len(comparisons), methods, loads, terms, returned=kept)
    data = data.drop_vars(set(data.data_vars) - {*DESCRIPTION, *kept})
    sizes = {str(dim): size for dim, size in data.sizes.items()}
    data = data.assign({name: variables.blank(name, sizes, own) for name in own})
    data = data.reset_index("solution_method").rename_dims(solution_method="variant")
    return data.assign_coords(
        variant=("variant", list(variants), variables.attributes("variant", {"variant": VARIANT}))
    )


def fill(data: xr.Dataset, comparisons: Sequence[Comparison], measure: Measure) -> None:
    """Run all variants on all cases, one after the other.

    `measure` returns the values of one run by the names of variables: arrays over the loads of the comparison, and
    scalars. Values that are not variables of the dataset are dropped.
    """
    names = data["variant"].values.tolist()
    for number, comparison in enumerate(comparisons):
        print(f"case {number + 1}/{len(comparisons)}: {comparison.name}", file=sys.stderr)
        describe_case(arrays(data), number, comparison.case, comparison.loads)
        columns = np.searchsorted(data["mean_pressure"].values, comparison.loads)
        for variant in comparison.variants:
            position = number, names.index(variant.name)
            settings = {"settings": json.dumps(dict(variant.settings), sort_keys=True)}
            for name, values in (settings | dict(measure(comparison, variant))).items():
                if name in data.data_vars:
                    data[name].values[(*position, columns) if np.ndim(values) else position] = values
