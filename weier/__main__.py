"""`weier`, and `python -m weier`."""

import os
import sys
from collections.abc import Sequence

from weier.pipeline.server import INTERRUPTED, delegate, say_interrupted


def run() -> None:
    """Run the command line, here or by a server."""
    sys.exit(_run(sys.argv[1:]))


def _run(arguments: Sequence[str]) -> int | str | None:
    """What to exit with; Ctrl-C ends the process here, in the midst of what other threads compute."""
    try:
        code = delegate(arguments)
        if code is not None:
            return code
        from weier.cli import main  # not where a server runs the command

        main()
    except KeyboardInterrupt:
        say_interrupted()
    except SystemExit as stopped:
        if stopped.code != INTERRUPTED:
            return stopped.code
    else:
        return 0
    sys.stderr.flush()
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    run()
