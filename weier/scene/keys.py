"""The JSON schema of scene files and the tables of their keys, from the models."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from weier.data.markdown import plain, table
from weier.scene.models import (
    AxisKeys,
    FigureKeys,
    InterfaceKeys,
    LoadRange,
    ProfileKeys,
    RandomKeys,
    Range,
    SceneKeys,
    StudyKeys,
    TraceKeys,
)

# The parts of a scene, in the order of their tables.
PARTS = (
    SceneKeys,
    StudyKeys,
    ProfileKeys,
    TraceKeys,
    RandomKeys,
    FigureKeys,
    InterfaceKeys,
    Range,
    LoadRange,
    AxisKeys,
)
HEAD = "key", "what it says", "value"
GENERATED = re.compile(r"(?<=<!-- keys of a scene -->\n).*?(?=<!-- end -->)", re.DOTALL)


class _Schema(GenerateJsonSchema):
    """The JSON schema without the titles that pydantic makes up."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def schema() -> dict[str, Any]:
    """Return the JSON schema of scene files, with the names of all methods there are."""
    made = SceneKeys.model_json_schema(schema_generator=_Schema)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | made


def tables() -> Iterator[tuple[str, str]]:
    """Yield the title of each part of a scene, and the Markdown table of its keys."""
    known = schema()
    for part in PARTS:
        within = known if part is SceneKeys else known["$defs"][part.__name__]
        needed = within.get("required", [])
        rows = [_row(name, of, name in needed, known) for name, of in within["properties"].items()]
        yield within["title"], table(HEAD, rows)


def _row(name: str, of: Mapping[str, Any], needed: bool, known: Mapping[str, Any]) -> list[str]:
    says = f"{of.get('description', '')}{' Required.' if needed else ''}"
    return [f"`{name}`", plain(says), plain(_kind(of, known))]


def _kind(part: Mapping[str, Any], known: Mapping[str, Any]) -> str:
    """Return the values that a part of the schema allows, in words."""
    if "title" in part:
        return str(part["title"])
    if "$ref" in part:
        return _kind(known["$defs"][part["$ref"].rpartition("/")[2]], known)
    if "enum" in part:
        return ", ".join(part["enum"])
    if alternatives := part.get("anyOf", part.get("oneOf")):
        return " or ".join(dict.fromkeys(_kind(alternative, known) for alternative in alternatives))
    if part["type"] == "array":
        return f"a list of {_kind(part['items'], known)}"
    return "mapping" if part["type"] == "object" else str(part["type"])


def write(folder: Path) -> None:
    """Write the schema and the table of keys into the folder of the configuration."""
    (folder / "scene.schema.json").write_text(json.dumps(schema(), indent=2) + "\n", encoding="utf-8")
    readme = folder / "README.md"
    text = readme.read_text(encoding="utf-8")
    (_, first), *_ = tables()
    readme.write_text(GENERATED.sub(lambda _: first + "\n", text), encoding="utf-8")
