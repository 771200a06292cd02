"""Products of a scene: the numbers, lists and ranges that each parameter takes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from weier.data.yaml import number

MAX_CASES = 10_000  # by default
MAX_RANGE_VALUES = 10**6

Product = Mapping[str, Any]


def products(study: Mapping[str, Any]) -> list[tuple[tuple[str | int, ...], Product]]:
    """The products of a study that are mappings, each with the keys that lead to it."""
    cases = study.get("cases")
    listed = [(("cases", number), each) for number, each in enumerate(cases if isinstance(cases, list) else [])]
    every = [(("product",), study.get("product")), *listed, *_traces(study.get("trace"))]
    return [(keys, product) for keys, product in every if isinstance(product, dict)]


def _traces(trace: Any) -> list[tuple[tuple[str | int, ...], Product]]:
    """A product of one trace for each file."""
    if not isinstance(trace, dict) or "file" not in trace:
        return []
    if not isinstance(files := trace["file"], list):
        return [(("trace", "file"), {"trace": trace})]
    return [(("trace", "file", number), {"trace": trace | {"file": file}}) for number, file in enumerate(files)]


def distinct_values(name: str, values: Any) -> list[Any]:
    """The values of one parameter, each once; a list within a list of phases are those of one profile."""
    given = values if name == "phases" and isinstance(values, list) else axis(values)
    return list({json.dumps(value): value for value in given}.values())


def check_count(studies: Mapping[str, Any], most: int) -> None:
    """Refuse too many cases, before any is made."""
    every = [product for study in studies.values() for _, product in products(study)]
    count = sum(math.prod(_count(name, values) for name, values in product.items()) for product in every)
    if count > most:
        raise ValueError(
            f"a scene must have at most {most} cases, got {count}: say max_cases: {count} if you mean it"
        )


def axis(values: Any) -> list[Any]:
    """A number, a list of numbers and ranges, or a range, as a list."""
    if isinstance(values, list):
        return [value for each in values for value in axis(each)]
    if not isinstance(values, dict):
        return [values]
    if values["count"] > MAX_RANGE_VALUES:
        raise ValueError(f"a range must have at most {MAX_RANGE_VALUES} values, got {values['count']}")
    ends = number("from", values["from"]), number("to", values["to"])
    if values.get("spacing") == "log" and not min(ends) > 0:
        raise ValueError(f"a range in equal ratios must lie above 0, got {min(ends):g}")
    if not np.isfinite(ends[1] - ends[0]):
        raise ValueError(f"a range must have finite ends, got {ends[0]:g} and {ends[1]:g}")
    space = np.geomspace if values.get("spacing") == "log" else np.linspace
    return [int(v) if v.is_integer() else v for v in space(*ends, int(values["count"])).tolist()]


def _count(name: str, values: Any) -> int:
    return len(values) if name == "phases" and isinstance(values, list) else _length(values)


def _length(values: Any) -> int:
    if isinstance(values, list):
        return sum(map(_length, values))
    return int(values.get("count", 1)) if isinstance(values, dict) else 1  # a range, or a file of heights
