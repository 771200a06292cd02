"""JSON schema of scene files and tables of their keys; `python -m weier.scene` writes them into `config/`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from weier.data.markdown import plain, table
from weier.scene import models

# parts of a scene and the headings of their tables, in order
PARTS: dict[str, type[models.Section]] = {
    "a scene": models.SceneKeys,
    "a study": models.StudyKeys,
    "a profile": models.ProfileKeys,
    "a trace": models.TraceKeys,
    "random lines": models.RandomKeys,
    "a figure": models.FigureKeys,
    "a range": models.Range,
    "a range of loads": models.LoadRange,
}
GENERATED = re.compile(r"(?<=<!-- keys of a scene -->\n).*?(?=<!-- end -->)", re.DOTALL)


def schema() -> dict[str, Any]:
    """Return the JSON schema of scene files, with the names of all registered methods."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | models.SceneKeys.model_json_schema()


def tables() -> Iterator[tuple[str, str]]:
    """Yield the heading of each part of a scene, and the Markdown table of its keys."""
    for heading, part in PARTS.items():
        rows = [[f"`{name}`", plain(says)] for name, says in part.keys().items()]
        yield heading, table(("key", "what it says"), rows)


def write(folder: Path) -> None:
    """Write the schema and the table of keys into the folder of the configuration."""
    (folder / "scene.schema.json").write_text(json.dumps(schema(), indent=2) + "\n", encoding="utf-8")
    readme = folder / "README.md"
    text = readme.read_text(encoding="utf-8")
    (_, first), *_ = tables()
    readme.write_text(GENERATED.sub(lambda _: first + "\n", text), encoding="utf-8")


if __name__ == "__main__":
    write(Path("config"))
