"""Set one thread for all programs, and run the command line."""

from benchmarks.threads import use_one_thread

NAMES = (
    *("artefacts", "direct_solution", "estimates", "expected_seconds"),
    *("grid_resistance", "node_counts", "same_grid", "to_error", "truncated_resistance", "tuning"),
)


def run() -> None:
    """Set one thread before a measurement imports NumPy, then run the command line."""
    use_one_thread()
    from weier.accuracy.measurement import commands

    commands("benchmarks", NAMES, "Compare weier with other programs, and measure its constants.")()


if __name__ == "__main__":
    run()
