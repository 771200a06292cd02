"""`weier`, and `python -m weier`."""

import atexit
import gc
import os
import sys

INTERRUPTED = 130  # exit code after Ctrl-C, as of shells
STOPPED = "weier: stopped by Ctrl-C; files that were being written are as they were"


def run() -> None:
    """Run the command line; Ctrl-C ends the process here, in the midst of what other threads compute."""
    # Nearly all that a command makes is used to its end. To look for garbage in it more often, and in all of it at
    # the end, takes a fifth of the time of most commands.
    gc.set_threshold(10_000)
    atexit.register(gc.freeze)
    try:
        from weier.cli import main  # within the block: to import it takes some tenths of a second

        main()
    except KeyboardInterrupt:
        print(STOPPED, file=sys.stderr, flush=True)
        os._exit(INTERRUPTED)


if __name__ == "__main__":
    run()
