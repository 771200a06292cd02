"""What a scene or a command may ask for, so that a slip of the pen ends in a sentence and not in a lost night."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from weier.profile import Profile, RandomPhases

MOST_TEXT = 10**6  # characters of a scene file
MOST_NODES = 10**6  # values of one, after each alias is written out
MOST_CASES = 10_000  # unless the scene says most_cases
MOST_LOADS = 10_000
MOST_RANGE = 10**6
MOST_TERMS = 1000  # of a finite series: the closed forms add them one by one
MOST_WAVES = 100_000  # of the finest term in one period: 6.4 million nodes, a gigabyte
MOST_PHASE = 1e6  # radians: a float of more has lost the digits that matter
MOST_POINTS = 10**7
MOST_DENSE = 10_000  # nodes of a dense matrix, which takes 0.8 GB, and its factors as much
MOST_BYTES = 4 * 2**30  # of one batch
LOADS = 1e-12, 1e12  # p_0*
GAMMA = 10**6
NUMERICAL = ("patches", "bem")  # solve the series itself, on all of its waves; the more accurate first

KEY_TAGS = "tag:yaml.org,2002:str", "tag:yaml.org,2002:merge"


def number(name: str, value: Any) -> float:
    """A number of a scene, be it written as text: YAML takes 1e-3 for a word.

    Raises
    ------
    ValueError
        If it is none, or too large for a float.

    """
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        shown = f"{value!s:.40}" if not isinstance(value, int) else "a number of too many digits"
        raise ValueError(f"{name} must be a number, got {shown!r}") from None


def safe_yaml(text: str) -> Any:
    """A YAML text as plain values: no objects, no keys given twice, no alias that grows without bound.

    Raises
    ------
    ValueError
        If it is not YAML, or not plain.

    """
    if len(text) > MOST_TEXT:
        raise ValueError(f"a scene must have at most {MOST_TEXT} characters, got {len(text)}")
    try:
        node = yaml.compose(text, yaml.SafeLoader)
        if node is not None:
            _size(node, {})
        return yaml.safe_load(text)
    except RecursionError:
        raise ValueError("the values are nested too deep, or contain themselves") from None
    except yaml.YAMLError as error:
        raise ValueError(str(error)) from None


def check_profile(profile: Profile, methods: Sequence[str]) -> None:
    """Refuse a series that no computer holds.

    Raises
    ------
    ValueError
        If it has too many terms or waves.

    """
    if profile.gamma > GAMMA:
        raise ValueError(f"gamma must be at most {GAMMA}, got {_short(profile.gamma)}")
    if math.isinf(profile.m):
        return
    if profile.m > MOST_TERMS:
        raise ValueError(f"m must be at most {MOST_TERMS}, or inf, got {profile.m:g}")
    drawn = isinstance(profile.phases, RandomPhases)  # within a turn, and slow to draw for each of 10^6 cases
    if not drawn and np.abs(profile.phase).max() > MOST_PHASE:
        raise ValueError(f"phases must lie in [-{MOST_PHASE:g}, {MOST_PHASE:g}], got {np.abs(profile.phase).max():g}")
    if any(method in NUMERICAL for method in methods):
        check_resolvable(profile)


def resolvable(profile: Profile) -> bool:
    """Whether the waves of one period can be sampled."""
    return (profile.m - 1) * math.log(profile.gamma.numerator) <= math.log(MOST_WAVES)


def check_resolvable(profile: Profile) -> None:
    """Refuse a finite series whose period holds more waves than a computer does.

    Raises
    ------
    ValueError
        If the finest wave fits too often into the period.

    """
    if not resolvable(profile):
        raise ValueError(
            f"the finest wave must fit at most {MOST_WAVES} times into the period, which {profile.describe()} "
            "exceeds: take fewer terms, or methods other than bem and patches"
        )


def check_points(points: int, dense: bool = False) -> None:
    """Refuse a grid that no computer holds, with a dense matrix or without.

    Raises
    ------
    ValueError
        If it has too many nodes.

    """
    most, instead = (MOST_DENSE, 'take solver "fft", or fewer') if dense else (MOST_POINTS, "take fewer")
    if points > most:
        raise ValueError(f"points must be at most {most}, got {points}: {instead}")


def check_loads(loads: NDArray[np.float64]) -> None:
    """Refuse loads so many, light or heavy that no number is left of them.

    Raises
    ------
    ValueError
        If a load or their count is out of range.

    """
    if loads.size > MOST_LOADS:
        raise ValueError(f"there must be at most {MOST_LOADS} loads, got {loads.size}")
    if loads[0] < LOADS[0] or loads[-1] > LOADS[1]:
        raise ValueError(f"loads must lie in [{LOADS[0]:g}, {LOADS[1]:g}] p_0*, got {loads[0]:g} to {loads[-1]:g}")


def check_memory(cases: int, methods: int, loads: int, edges: int, variables: int) -> None:
    """Refuse a batch that does not fit into memory.

    Raises
    ------
    ValueError
        If it would take too many bytes.

    """
    needed = 8 * cases * loads * (methods * variables + edges)
    if needed > MOST_BYTES:
        raise ValueError(
            f"a batch must fit into {MOST_BYTES >> 30} GB, got {needed >> 30} GB: set a smaller batch, fewer loads, "
            "or contact_edges: false"
        )


def _short(ratio: Fraction) -> str:
    """A ratio in a few characters, be it too large for a float."""
    digits = math.log10(ratio.numerator) - math.log10(ratio.denominator)
    return f"{float(ratio):.15g}" if digits < 300 else f"about 1e{digits:.0f}"


def _size(node: yaml.Node, known: dict[int, int]) -> int:
    """How many values a node stands for, each alias written out; a node within itself never ends."""
    if id(node) not in known:
        children = _children(node)
        known[id(node)] = 1 + sum(_size(child, known) for child in children)
    if known[id(node)] > MOST_NODES:
        raise ValueError(f"the scene must have at most {MOST_NODES} values, each alias written out: got more")
    return known[id(node)]


def _children(node: yaml.Node) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        keys = [key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        twice = [key for key in keys if keys.count(key) > 1] if len(keys) > len(set(keys)) else []
        if twice:
            raise ValueError(f"the key {twice[0]!r} stands twice in one place")
        odd = [key.start_mark.line + 1 for key, _ in node.value if key.tag not in KEY_TAGS]
        if odd:
            raise ValueError(f"a key must be a word, got another kind of value in line {odd[0]}")
        return [child for pair in node.value for child in pair]
    return node.value if isinstance(node, yaml.SequenceNode) else []
