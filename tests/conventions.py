"""The CF and ACDD checker, run on files, for the tests of whatever writes files."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any


def check(files: Sequence[Path], conventions: Sequence[str], folder: Path) -> dict[str, dict[str, Any]]:
    """The whole answer of the checker for each convention and file, by the name of the file; it has no network."""
    output = folder / "answers.json"
    environment = os.environ | dict.fromkeys(("http_proxy", "https_proxy"), "http://127.0.0.1:9")
    tests = [word for convention in conventions for word in ("-t", convention)]
    command = ["cchecker.py", *tests, "-c", "strict", "-f", "json_new", "-o", output, *files]
    done = subprocess.run(list(map(str, command)), env=environment, capture_output=True, text=True, timeout=300)
    assert "exceptions occurred" not in done.stdout + done.stderr, done.stdout + done.stderr
    answers = json.loads(output.read_text(encoding="utf-8"))
    assert set(answers) == set(map(str, files))
    return {one: {name: answer[one] for name, answer in answers.items()} for one in conventions}


def complaints(answer: Any) -> list[str]:
    """The messages of an answer, of all priorities."""
    ranks = ("high_priorities", "medium_priorities", "low_priorities")
    return [text for rank in ranks for check in answer[rank] for text in check["msgs"]]
