"""Markdown: tables, and text that stays as it is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, a line a row, of cells that are Markdown."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, ["---"] * len(head), *rows))


def plain(text: str) -> str:
    """Text that Markdown does not read as emphasis or a new column."""
    return text.replace("_", r"\_").replace("*", r"\*").replace("|", r"\|")
