"""YAML as plain values: no objects, no aliases that grow without bound, no duplicate keys."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import yaml

from weier.checks import checked_number, shown

MAX_CHARACTERS = 10**6  # A file has at most so many characters, which bounds time and memory.
MAX_VALUES = 10**6  # A file has at most so many values after aliases are expanded, for the same reason.
# The only kinds of keys are texts and the merge key "<<".
KEY_TAGS = "tag:yaml.org,2002:str", "tag:yaml.org,2002:merge"


class _Loader(yaml.SafeLoader):
    """Plain values as in YAML 1.2: by YAML 1.1, PyYAML reads 012 as 10, 1:30 as 90, on as true, and 1e-3 as text."""


# Patterns of plain values in the core schema of YAML 1.2.
PLAIN_VALUES = {
    "null": r"~|null|Null|NULL|",
    "bool": r"true|True|TRUE|false|False|FALSE",
    "int": r"[-+]?\d+",
    "float": r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
    "merge": "<<",
}
_Loader.yaml_implicit_resolvers = {}
for kind, pattern in PLAIN_VALUES.items():
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{kind}", re.compile(rf"({pattern})$", re.ASCII), None)
_Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))


class Document(NamedTuple):
    """A YAML text: its plain values, and its nodes with their line numbers."""

    values: Any
    root: yaml.Node | None

    def line(self, keys: Sequence[str | int]) -> int:
        """The line of the value at these keys, or of the last key that exists; the first line is 1."""
        node, mark = self.root, self.root.start_mark if self.root else None
        for key in keys:
            found = _child(node, key)
            if found is None:
                break
            mark, node = found
        return mark.line + 1 if mark else 1


def parse_yaml(text: str) -> Any:
    """A YAML text as plain values; objects, duplicate keys and aliases that grow without bound are refused."""
    return read_yaml(text).values


def read_yaml(text: str) -> Document:
    """The values of a YAML text as `parse_yaml` has them, with their lines."""
    if len(text) > MAX_CHARACTERS:
        raise ValueError(f"a YAML text must have at most {MAX_CHARACTERS} characters, got {len(text)}")
    try:
        loader = _Loader(text)
        root = loader.get_single_node()
        _size(root, {})
        return Document(loader.construct_document(root) if root else None, root)
    except RecursionError:
        raise ValueError("the values are nested too deep, or contain themselves") from None
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise ValueError(f"{line}{error.problem or error}") from None
    except yaml.YAMLError as error:
        raise ValueError(str(error)) from None


def number(name: str, value: Any) -> float:
    """A number, which may be given as text; ValueError if it is none, or too large for a float."""
    if not isinstance(value, str):
        return checked_number(name, value)
    try:
        return float(value)
    except ValueError:
        raise ValueError(f"{name} must be a number, got {shown(value)}") from None


def _size(node: yaml.Node | None, known: dict[int, int]) -> int:
    """The number of values of a node with aliases expanded; a node that contains itself raises RecursionError."""
    if id(node) not in known:
        children = _checked_children(node)
        known[id(node)] = 1 + sum(_size(child, known) for child in children)
    if known[id(node)] > MAX_VALUES:
        raise ValueError(f"a YAML text must have at most {MAX_VALUES} values, each alias written out: got more")
    return known[id(node)]


def _checked_children(node: yaml.Node | None) -> list[yaml.Node]:
    """The child nodes of a node; ValueError if a key is not a text, or is duplicate."""
    if isinstance(node, yaml.MappingNode):
        seen = set[str]()
        for key, _ in node.value:
            line = key.start_mark.line + 1
            if key.tag not in KEY_TAGS or not isinstance(key, yaml.ScalarNode):
                raise ValueError(f"a key must be a word, got another kind of value in line {line}")
            if key.value in seen:
                raise ValueError(f"line {line}: the key {key.value!r} occurs twice")
            seen.add(key.value)
        return [child for pair in node.value for child in pair]
    return node.value if isinstance(node, yaml.SequenceNode) else []


def _child(node: yaml.Node | None, key: str | int) -> tuple[yaml.Mark, yaml.Node] | None:
    """The position of a key of a mapping or an item of a list, and its value; merged keys come first."""
    if isinstance(node, yaml.SequenceNode) and isinstance(key, int) and key < len(node.value):
        return node.value[key].start_mark, node.value[key]
    pairs = node.value if isinstance(node, yaml.MappingNode) else []
    return {name.value: (name.start_mark, value) for name, value in pairs}.get(key)
