"""The measurements of weier itself: `python -m weier.accuracy NAME`."""

from importlib import import_module

import click

from weier.accuracy.report import CONTEXT
from weier.methods.errors import ConvergenceError

NAMES = (
    *("artefacts", "convergence", "coverage", "direct_solution", "estimates", "expected_seconds", "extremes"),
    *("node_counts", "tradeoff", "tuning"),
)


class Measurements(click.Group):
    """A command for each of these modules, which is imported for it; bad input ends in one sentence."""

    def list_commands(self, context: click.Context) -> list[str]:
        """Return the names of all measurements."""
        return list(NAMES)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        """Return the command of a measurement."""
        return import_module(f"weier.accuracy.{name}").main if name in NAMES else None

    def invoke(self, context: click.Context) -> None:
        """Run the command, and report an error that is no fault of the program."""
        try:
            super().invoke(context)
        except (ValueError, ConvergenceError, OSError) as error:
            raise click.ClickException(str(error)) from None


@click.command(cls=Measurements, context_settings=CONTEXT)
def main() -> None:
    """Measure weier itself: errors, computing time, and coverage of the stated errors.

    Each command writes a page of Markdown, by default results/NAME/NAME.md, and prints it. If a figure is drawn from
    it, its data are written beside it as netCDF.
    """


if __name__ == "__main__":
    main(prog_name="python -m weier.accuracy")
