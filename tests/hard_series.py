"""Series under loads that were solved wrongly once, as the data file lists them for several tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from weier import Profile

DATA = Path(__file__).parent / "data" / "hard_series.yaml"


def hard_series(table: str) -> Any:
    """A test of each row in a table: of its `profile`, its `loads`, and what else its rows have, in their order."""
    rows = yaml.safe_load(DATA.read_text(encoding="utf-8"))[table]
    series = [Profile(row.pop("D"), row.pop("gamma"), len(row["phases"]), row.pop("phases")) for row in rows]
    values = [(profile, *row.values()) for profile, row in zip(series, rows, strict=True)]
    return pytest.mark.parametrize(("profile", *rows[0]), values)
