"""All methods of solution, from the least to the most accurate: the program knows methods from this list only.

To add a method, write its `METHOD` and list it in METHODS.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from weier.checks import checked_word
from weier.methods import archard, auto, bem, cascade, demelio, layer, patches, persson, westergaard
from weier.methods.curve import QUANTITIES
from weier.methods.errors import NotApplicableError
from weier.methods.method import Method
from weier.surface.waves import Waves

METHODS: tuple[Method, ...] = (
    westergaard.METHOD,
    archard.METHOD,
    demelio.METHOD,
    persson.METHOD,
    cascade.METHOD,
    layer.METHOD,
    bem.METHOD,
    patches.METHOD,
    auto.METHOD,
)
# the default methods: with a tolerance, and without
WITHIN_TOLERANCE, EXACT = auto.METHOD, patches.METHOD
# methods of the paper's figures, and Persson's theory
PLOTTED = tuple(module.METHOD.name for module in (archard, demelio, persson, layer, patches))


def default_method(*surfaces: Waves, within_tolerance: bool = False) -> str:
    """Return the default method of some surfaces: contact patches, or "auto" if a tolerance is given.

    NotApplicableError is raised for the infinite series without a tolerance, which no method solves exactly.
    """
    if within_tolerance:
        return WITHIN_TOLERANCE.name
    if any(math.isinf(surface.m) for surface in surfaces):
        raise NotApplicableError(
            f"a tolerance or a method must be given where m = inf: tolerance=1e-3, or one of the methods "
            f"{', '.join(infinite_names())}"
        )
    return EXACT.name


def methods_run_by(name: str) -> tuple[Method, ...]:
    """Return the methods that a method may run: itself, or all if it chooses among them."""
    method = find_method(name)
    return METHODS if method is WITHIN_TOLERANCE else (method,)


def names() -> list[str]:
    """Return the names of all methods."""
    return [method.name for method in METHODS]


def numerical_names() -> list[str]:
    """Return the names of the methods that solve the truncated series itself, the most accurate first."""
    return [method.name for method in reversed(METHODS) if method.numerical]


def infinite_names() -> list[str]:
    """Return the names of the methods that apply to the infinite series."""
    return [method.name for method in METHODS if method.infinite]


def returned_by(methods: Iterable[str]) -> set[str]:
    """Return the names of all values returned by these methods."""
    return {*QUANTITIES}.union(*(find_method(method).returns for method in methods))


def find_method(name: str) -> Method:
    """Return the method of this name; ValueError is raised if there is none."""
    by_name = {method.name: method for method in METHODS}
    return by_name[checked_word("method", name, by_name)]
