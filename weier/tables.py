"""Numbers with few digits, and tables as HTML for notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape


def significant(value: float, count: int) -> str:
    """Format a number with this many significant digits, without exponent if short: 430, not 4.3e+02."""
    return f"{float(f'{value:.{count}g}'):g}"


def html_table(caption: str, header: Sequence[str], rows: Sequence[Sequence[str]], footer: str = "") -> str:
    """Return a table as notebooks show it."""
    head = "".join(f'<th style="text-align: left">{escape(cell)}</th>' for cell in header)
    lines = ("".join(f'<td style="text-align: left">{escape(cell)}</td>' for cell in row) for row in rows)
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    below = f"<p>{escape(footer)}</p>" if footer else ""
    return f"<p>{escape(caption)}</p><table><tr>{head}</tr>{body}</table>{below}"
