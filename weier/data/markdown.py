"""Markdown tables, and escaped text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of cells that are Markdown, one line per row."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, ["---"] * len(head), *rows))


def plain(text: str) -> str:
    """Return text that Markdown does not read as emphasis or a new column."""
    return text.replace("_", r"\_").replace("*", r"\*").replace("|", r"\|")
