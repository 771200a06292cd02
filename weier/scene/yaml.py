"""YAML 1.2 as plain values, no objects and no duplicate keys; and mistakes in such a file, with their lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, StringMark, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from weier.checks import MAX_SHOWN, checked_number
from weier.units import NONE, parsed

MAX_DEPTH = 50  # A scene has ten levels; deeper nesting would exceed Python's recursion limit.
Keys = tuple[str | int, ...]


class Document(NamedTuple):
    """A YAML text: its plain values, and its nodes with their line numbers."""

    values: Any
    root: Node | None

    def line(self, keys: Keys) -> int:
        """Return the line of the value at these keys, without those that the text lacks; the first line is 1."""
        node, mark = self.root, self.root.start_mark if self.root else None
        for key in keys:
            mark, node = _child(node, key) or (mark, node)
        return mark.line + 1 if mark else 1


def read_yaml(text: str) -> Document:
    """Return a YAML text as plain values with their lines; objects and duplicate keys are refused."""
    yaml = YAML(typ="safe", pure=True)
    yaml.max_depth = MAX_DEPTH
    try:
        root = yaml.compose(text)
        return Document(yaml.constructor.construct_document(root) if root else None, root)
    except MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise ValueError(f"{line}{error.problem or error}") from None
    except YAMLError as error:
        raise ValueError(str(error)) from None


def number(name: str, value: Any, unit: str = NONE) -> float:
    """Return a number in `unit`, which may be given as text, with a unit of its own; ValueError if it is none."""
    return checked_number(name, parsed(name, value, unit))


def _child(node: Node | None, key: str | int) -> tuple[StringMark, Node] | None:
    """Return the position of a key or list item, and the node of its value; own keys override merged ones."""
    if isinstance(node, SequenceNode) and isinstance(key, int) and key < len(node.value):
        return node.value[key].start_mark, node.value[key]
    pairs = node.value if isinstance(node, MappingNode) else []
    return {str(name.value): (name.start_mark, value) for name, value in pairs}.get(str(key))


class SceneError(ValueError):
    """A scene file that cannot be run: the message names the file, and the line and the key of each mistake."""


class Mistake(Exception):  # noqa: N818 - a part of the error that users see, `SceneError`
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
