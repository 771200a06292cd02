"""Variants of methods on cases, side by side in one dataset."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from weier.data import dataset, variables
from weier.data.variables import LABEL, Variable
from weier.kernels.arrays import Array
from weier.methods.method import Variant
from weier.pipeline.batch import arrays, describe_case
from weier.scene import Case

DESCRIPTION = ("total_amplitude", "tail_amplitude", "first_contact")  # of a case, beside its coordinates
VARIANT = Variable(("variant",), "method and settings that are compared", content=LABEL)


class Comparison(NamedTuple):
    """A profile and what is run on it.

    name : in a few words
    case : the profile, by the parameters of a scene
    loads : mean pressures, shape (loads,), increasing, in p_0*
    variants : methods and settings
    """

    name: str
    case: Case
    loads: Array
    variants: tuple[Variant, ...]


Measure = Callable[[Comparison, Variant], Mapping[str, Any]]


def blank(comparisons: Sequence[Comparison], kept: Collection[str], own: Mapping[str, Variable]) -> xr.Dataset:
    """A dataset for the comparisons with nothing in it yet.

    It is that of a scene, over variants instead of methods: the method of each is the coordinate solution_method.
    `kept` names variables of the common table; `own` are further ones, whose dimension of variants is called
    solution_method as in that table.
    """
    # Each variant once, by name, in the order of the comparison that has most of them.
    lists = sorted((each.variants for each in comparisons), key=len, reverse=True)
    variants = {variant.name: variant for each in lists for variant in each}
    methods = [variant.method for variant in variants.values()]
    loads = np.unique(np.concatenate([each.loads for each in comparisons]))
    finite = [each.case.profile for each in comparisons if np.isfinite(each.case.profile.m)]
    data = dataset.blank(len(comparisons), methods, loads, max((profile.terms for profile in finite), default=1))
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
    scalars. What is no variable of the dataset is left out.
    """
    names = data["variant"].values.tolist()
    for number, each in enumerate(comparisons):
        print(f"case {number + 1}/{len(comparisons)}: {each.name}", file=sys.stderr)
        describe_case(arrays(data), number, each.case)
        columns = np.searchsorted(data["mean_pressure"].values, each.loads)
        for variant in each.variants:
            position = number, names.index(variant.name)
            settings = {"settings": json.dumps(dict(variant.settings), sort_keys=True)}
            for name, values in (settings | dict(measure(each, variant))).items():
                if name in data.data_vars:
                    data[name].values[(*position, columns) if np.ndim(values) else position] = values
