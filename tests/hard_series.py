"""Series under loads that were solved wrongly once, as the data file lists them for several tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from weier import Profile

DATA = Path(__file__).parent / "data" / "hard_series.yaml"


def hard_series(table: str) -> Any:
    """A test of each row in a table: of its `profile`, and of what else rows have, None where this one has not."""
    rows = yaml.safe_load(DATA.read_text(encoding="utf-8"))[table]
    others = list(dict.fromkeys(key for row in rows for key in row if key not in ("D", "gamma", "phases")))
    series = [Profile(row["D"], row["gamma"], len(row["phases"]), row["phases"]) for row in rows]
    values = [(profile, *map(row.get, others)) for profile, row in zip(series, rows, strict=True)]
    return pytest.mark.parametrize(("profile", *others), values)
