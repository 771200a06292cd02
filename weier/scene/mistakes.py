"""The mistakes of a scene file: those of one kind are reported together."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple, TypeVar

from weier.checks import MAX_SHOWN
from weier.scene.yaml import Document

Value = TypeVar("Value")
Other = TypeVar("Other")
Keys = tuple[str | int, ...]


class SceneError(ValueError):
    """A scene file that cannot be run: the message names the file, and the line and the key of each mistake."""


class Mistake(NamedTuple):
    """A mistake in words, at the place of these keys."""

    keys: Keys
    text: str


class Mistakes(dict[Keys, str]):
    """The mistakes found in a scene, at most one at each place."""

    def add(self, found: Iterable[Mistake]) -> None:
        """Add mistakes, except in parts of the file that already have one, since it may be the cause."""
        for keys, text in found:
            if not self.within(*keys):
                self[keys] = text

    def within(self, *keys: str | int) -> bool:
        """Return whether there are mistakes in the part of the file at these keys."""
        return any(place[: len(keys)] == keys for place in self)

    def attempt(self, keys: Keys, read: Callable[[], Value], instead: Other) -> Value | Other:
        """Return the result of `read`; after a ValueError or OSError, record a mistake and return `instead`."""
        if self.within(*keys):
            return instead
        try:
            return read()
        except TimeoutError:  # the caller's time limit
            raise
        except (OSError, ValueError) as error:
            self[keys] = str(error)
            return instead

    def error(self, path: Path, document: Document) -> SceneError:
        """Return all mistakes as one error, in the order of their lines; several are listed one per line."""
        ordered = sorted((document.line(keys), _described(keys, text)) for keys, text in self.items())
        listed = [f"line {line}: {text}" for line, text in ordered]
        if len(ordered) == 1:
            return SceneError(f"{path}, {listed[0]}")
        return SceneError("\n  ".join([f"{path} has {len(ordered)} mistakes:", *listed]))


def _described(keys: Keys, text: str) -> str:
    where = ".".join(one_line(key)[:MAX_SHOWN] for key in keys)
    return f"{where}: {one_line(text)}" if where else one_line(text)


def one_line(text: object) -> str:
    """Return a text with its line breaks removed."""
    return " ".join(str(text).split())
