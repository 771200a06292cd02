"""One thread for all programs, then the command line."""

from benchmarks.threads import use_one_thread


def run() -> None:
    """The command line, which imports NumPy, and that reads the number of threads."""
    use_one_thread()
    from benchmarks.command import main

    main()


run()
