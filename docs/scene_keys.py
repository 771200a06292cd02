"""Tables of the keys of scene files; `python docs/scene_keys.py` writes the first one into `config/README.md`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

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


def tables() -> Iterator[tuple[str, str]]:
    """Yield the heading of each part of a scene, and the Markdown table of its keys."""
    for heading, part in PARTS.items():
        rows = [
            [f"`{key.alias or name}`", plain(f"{key.description}{' Required.' if key.is_required() else ''}")]
            for name, key in part.model_fields.items()
        ]
        yield heading, table(("key", "what it says"), rows)


def write(readme: Path) -> None:
    """Write the table of the keys of a scene into a Markdown file."""
    text = readme.read_text(encoding="utf-8")
    (_, first), *_ = tables()
    readme.write_text(GENERATED.sub(lambda _: first + "\n", text), encoding="utf-8")


if __name__ == "__main__":
    write(Path("config/README.md"))
