"""`weier`, and `python -m weier`."""

import atexit
import gc
import os
import sys

STOPPED = "weier: stopped; each file is whole, or as it was before"


def run() -> None:
    """Run the command line; Ctrl-C ends the process at once, without waiting for other threads."""
    # Nearly all objects of a command live until its end, so that garbage collection finds little. The threshold makes
    # collections rarer, and gc.freeze exempts all objects from the full one at the end of the interpreter. Together
    # they save 0.1 s of 0.7 s for `weier solve` by a closed form, and 0.4 s of 2 s for `weier plot` or contact
    # patches.
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
    os.environ["MPLBACKEND"] = "agg"  # Figures go to files. Jupyter names a backend that this environment may lack.
    # Kernels are compiled in nine tenths of the time of LLVM's level 3, and give the same digits as fast
    # (docs/compiling.md).
    os.environ.setdefault("NUMBA_OPT", "1")
    try:
        from weier.cli import main  # The import takes some tenths of a second, in which Ctrl-C may come.

        main()
    except KeyboardInterrupt:
        print(STOPPED, file=sys.stderr, flush=True)
        os._exit(130)  # Shells give this exit code to a program that Ctrl-C ended: 128 and the number of SIGINT.


if __name__ == "__main__":
    run()
