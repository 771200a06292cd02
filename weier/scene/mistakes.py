"""The mistakes of a scene file: all of them are found before any is reported."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple, TypeVar

from weier.data.yaml import Document
from weier.theory.arguments import MAX_SHOWN

MAX_TOLD = 30  # mistakes in one message

Value = TypeVar("Value")
Other = TypeVar("Other")
Keys = tuple[str | int, ...]


class SceneError(ValueError):
    """A scene file that cannot be run: the message names the file, and the line and the key of each mistake."""


class Mistake(NamedTuple):
    """What is wrong, in words, at the place that these keys lead to."""

    keys: Keys
    text: str


class Mistakes(dict[Keys, str]):
    """The mistakes that are found while a scene is read, one at each place."""

    def add(self, found: Iterable[Mistake]) -> None:
        """Add some, but for parts of the file that have one: it may be the cause of the others."""
        for keys, text in found:
            if not self.within(*keys):
                self[keys] = text

    def within(self, *keys: str | int) -> bool:
        """Whether there are any in the part of the file that these keys lead to."""
        return any(place[: len(keys)] == keys for place in self)

    def attempt(self, keys: Keys, read: Callable[[], Value], instead: Other) -> Value | Other:
        """What `read` finds there, or another value where there is a mistake: a ValueError or OSError reports it."""
        if self.within(*keys):
            return instead
        try:
            return read()
        except (OSError, ValueError) as error:
            self[keys] = str(error)
            return instead

    def error(self, path: Path, document: Document) -> SceneError:
        """All of them as one error, in the order of their lines: a line for one, a list of lines for several."""
        ordered = sorted((document.line(keys), _told(keys, text)) for keys, text in self.items())
        listed = [f"line {line}: {text}" for line, text in ordered[:MAX_TOLD]]
        if len(ordered) == 1:
            return SceneError(f"{path}, {listed[0]}")
        more = [f"and {len(ordered) - MAX_TOLD} more"] if len(ordered) > MAX_TOLD else []
        return SceneError("\n  ".join([f"{path} has {len(ordered)} mistakes:", *listed, *more]))


def _told(keys: Keys, text: str) -> str:
    where = ".".join(one_line(key)[:MAX_SHOWN] for key in keys)
    return f"{where}: {one_line(text)}" if where else one_line(text)


def one_line(text: object) -> str:
    """A text without the ends of its lines."""
    return " ".join(str(text).split())
