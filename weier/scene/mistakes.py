"""The mistakes of a scene file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from weier.checks import MAX_SHOWN
from weier.scene.yaml import Document

Keys = tuple[str | int, ...]


class SceneError(ValueError):
    """A scene file that cannot be run: the message names the file, and the line and the key of each mistake."""


class Mistake(Exception):  # noqa: N818
    """A mistake in words, at the place of these keys."""

    def __init__(self, keys: Keys, text: str) -> None:
        super().__init__(keys, text)
        self.keys, self.text = keys, text


@contextmanager
def at(*keys: str | int) -> Iterator[None]:
    """Raise a ValueError or OSError as a mistake at the place of these keys."""
    try:
        yield
    except TimeoutError:  # the caller's time limit
        raise
    except (OSError, ValueError) as error:
        raise Mistake(keys, str(error)) from None


def scene_error(path: Path, document: Document, mistakes: Iterable[Mistake]) -> SceneError:
    """Return all mistakes as one error, in the order of their lines; several are listed one per line."""
    ordered = sorted((document.line(one.keys), _described(one)) for one in mistakes)
    listed = [f"line {line}: {text}" for line, text in ordered]
    if len(ordered) == 1:
        return SceneError(f"{path}, {listed[0]}")
    return SceneError("\n  ".join([f"{path} has {len(ordered)} mistakes:", *listed]))


def _described(mistake: Mistake) -> str:
    where = ".".join(one_line(key)[:MAX_SHOWN] for key in mistake.keys)
    return f"{where}: {one_line(mistake.text)}" if where else one_line(mistake.text)


def one_line(text: object) -> str:
    """Return a text with its line breaks removed."""
    return " ".join(str(text).split())
