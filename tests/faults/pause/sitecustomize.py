"""Stop a process at its worst moment: the file is written, and not yet in its place.

On the path of a Python with PAUSE_AT and PAUSE_FILE in its environment. It leaves its number in PAUSE_FILE, and goes
on once that is gone.
"""

import os
import time
from pathlib import Path

replace = os.replace


def paused_replace(source, target, **options):
    if str(target).endswith(os.environ.get("PAUSE_AT", "\0")):
        del os.environ["PAUSE_AT"]  # a process stops once
        here = Path(os.environ["PAUSE_FILE"])
        here.write_text(str(os.getpid()))
        while here.exists():
            time.sleep(0.02)
    replace(source, target, **options)


if "PAUSE_AT" in os.environ:
    os.replace = paused_replace
