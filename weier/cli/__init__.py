"""The command line: its commands read arguments and call the same functions as the Python interface.

Imports all other folders of weier, and is imported by none.
"""

from __future__ import annotations

import signal
import sys
import warnings

import click

from weier.cli import one_profile, rules, tables
from weier.data.provenance import VERSION
from weier.methods.errors import ConvergenceError
from weier.scene import SceneError
from weier.scene.yaml import one_line

COMMANDS = [one_profile.solve, one_profile.plot, tables.report, tables.table]
COMMANDS += [rules.compile, rules.adopt, rules.curves, rules.make]


@click.group(
    commands=COMMANDS,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Exit codes: 0 done; 1 bad input or a solver that missed its tolerance, with a message; 2 wrong usage; "
    "130 stopped by Ctrl-C.",
)
@click.version_option(VERSION)
def cli() -> None:
    """Contact stiffness and contact resistance of the Weierstrass profile.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --loads 0.01:1:5        one profile, as JSON
    weier plot -D 1.25 --gamma 5 -m 3 curves.png               its curves by several methods
    weier solve -D 1.25 --gamma 5 -m inf --tolerance 1e-2      curves within a tolerance
    weier solve --trace shaft.csv --loads 0.01:1:5             measured heights
    weier report shaft*.csv --si bodies.yaml --pressures 1:100:20MPa -o report.csv -o report.png
    weier table results/paper/contact.nc curves.csv            curves for a spreadsheet
    snakemake --cores 2 --config scenes=minimal                a scene, in a checkout
    """


def main() -> None:
    """Run the command line; bad input and failed solves end in one sentence and exit code 1, by `sys.exit`."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # by a time limit, as by Ctrl-C
    warnings.showwarning = lambda message, *_: click.echo(f"weier: {message}", err=True)
    try:
        sys.exit(cli(prog_name="weier", standalone_mode=False))
    except click.Abort:  # Ctrl-C; click would exit with code 1
        raise KeyboardInterrupt from None
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except ModuleNotFoundError as error:
        sys.exit(f"weier: {error}: pip install 'weier[pipeline]', or requirements/run.txt of a checkout")
    except MemoryError:
        sys.exit("weier: not enough memory: take fewer points, loads or cases")
    except (ValueError, ConvergenceError, OSError) as error:
        sys.exit(f"weier: {error if isinstance(error, SceneError) else one_line(error)}")
