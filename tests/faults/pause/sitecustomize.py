"""Stop a process at its worst moment: the file is written, and not yet in its place.

On the path of a Python with PAUSE_AT and PAUSE_FILE in its environment. It leaves its number in PAUSE_FILE, which is
empty, and goes on once that is gone. No other process stops then.
"""

import os
import time
from pathlib import Path

replace = os.replace


def paused_replace(source, target, **options):
    here = Path(os.environ["PAUSE_FILE"])
    if str(target).endswith(os.environ["PAUSE_AT"]) and here.exists() and not here.read_text():
        here.write_text(str(os.getpid()))
        while here.exists():
            time.sleep(0.02)
    replace(source, target, **options)


if "PAUSE_AT" in os.environ:
    os.replace = paused_replace
