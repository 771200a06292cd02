"""Markdown pages of measurements, and their numbers."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np

from weier.data.files import write_text


def number(value: float, form: str = ".0e") -> str:
    """Return a number in this format; empty for NaN."""
    return "" if np.isnan(value) else format(float(value), form)


def write_page(path: str | Path, template: str, **parts: object) -> None:
    """Write a page from a template of this folder, whose names in braces are replaced by the parts."""
    text = files("weier.accuracy").joinpath(template).read_text(encoding="utf-8")
    write_text(path, text.format(**parts))
