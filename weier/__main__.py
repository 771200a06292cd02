"""`weier`, and `python -m weier`."""

import os
import sys

INTERRUPTED = 130  # exit code after Ctrl-C, as of shells
STOPPED = "weier: stopped by Ctrl-C; files that were being written are as they were"


def run() -> None:
    """Run the command line; Ctrl-C ends the process here, in the midst of what other threads compute."""
    try:
        from weier.cli import main  # within the block: to import it takes some tenths of a second

        main()
    except KeyboardInterrupt:
        print(STOPPED, file=sys.stderr, flush=True)
        os._exit(INTERRUPTED)


if __name__ == "__main__":
    run()
