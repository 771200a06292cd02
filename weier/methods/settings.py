"""The settings of methods: keywords of their solvers, which are checked before a solution."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from weier.methods.method import Method
from weier.methods.registry import METHODS, find_method

TOLERANCE = "tolerance"  # the setting that has the same meaning in all methods


def check_names(method: Method, settings: Iterable[str]) -> None:
    """Raise ValueError for unknown settings, naming the methods that have them."""
    known = method.settings
    for setting in settings:
        if setting not in known:
            choice = f"it takes {', '.join(known)}" if known else "it takes none"
            owners = f"; {setting!r} is a setting of {', '.join(found)}" if (found := methods_with(setting)) else ""
            raise ValueError(f'method "{method.name}" has no setting {setting!r}: {choice}{owners}')


def methods_with(setting: str) -> list[str]:
    """Return the names of the methods that have a setting of this name."""
    return [f'"{method.name}"' for method in METHODS if setting in method.settings]


def checked_settings(method: Method, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings, if the method takes them: of the right kind and within range."""
    check_names(method, settings)
    return {
        name: method.settings[name].checked(f"{name} of {method.name}", given) for name, given in settings.items()
    }


def with_tolerance(
    methods: Iterable[str], settings: Mapping[str, Mapping[str, Any]], tolerance: float | None
) -> dict[str, dict[str, Any]]:
    """Return settings by method, with the tolerance added where a method takes one and has none.

    ValueError is raised if no method takes a tolerance.
    """
    given = {method: dict(own) for method, own in settings.items()}
    if tolerance is None:
        return given
    takers = [name for name in methods if TOLERANCE in find_method(name).settings]
    if not takers:
        raise ValueError(
            f"tolerance is a setting of {', '.join(methods_with(TOLERANCE))}, and none of these is among the methods "
            f"{', '.join(methods)}"
        )
    for name in takers:
        given[name] = {TOLERANCE: tolerance} | given.get(name, {})
    return given


def all_settings(method: Method, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings that a method uses: given values and defaults, without None."""
    given = {name: value for name, value in settings.items() if value is not None}
    used = {**defaults(method), **method.chosen(given), **given}
    return {name: value for name, value in used.items() if value is not None}


def defaults(method: Method) -> dict[str, Any]:
    """Return every setting of a method at its default."""
    return {name: setting.default for name, setting in method.settings.items()}


def described(methods: Iterable[Method]) -> list[tuple[str, str]]:
    """Return every setting of some methods with its default, such as `layer.points=16`, and its meaning."""
    return [
        (f"{method.name}.{name}" + ("" if default is None else f"={default}"), meaning)
        for method in methods
        for name, (default, meaning, _) in method.settings.items()
    ]
