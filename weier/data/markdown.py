"""Markdown tables, escaped text, and numbers with few digits."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of cells that are Markdown, one line per row."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, ["---"] * len(head), *rows))


def plain(text: str) -> str:
    """Escape text so that Markdown reads no emphasis and no new column in it."""
    return text.replace("_", r"\_").replace("*", r"\*").replace("|", r"\|")


def significant(value: float, count: int) -> str:
    """Format a number with this many significant digits, without exponent if short: 430, not 4.3e+02."""
    return f"{float(f'{value:.{count}g}'):g}"
