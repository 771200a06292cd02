"""The command line: its commands read arguments and call the same functions as the Python interface.

May use all other folders of weier, and none of them uses it.
"""

from __future__ import annotations

import sys
from typing import NoReturn

import click

from weier.cli import measure, plan, profile, scene
from weier.data.provenance import VERSION
from weier.kernels.jit import announce_compiling
from weier.methods.errors import ConvergenceError

EXIT = "Exit codes: 0 done; 1 bad input or a solver that missed its tolerance, told in one sentence; 2 wrong usage."


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100}, epilog=EXIT)
@click.version_option(VERSION)
def cli() -> None:
    """Contact stiffness and contact resistance of the Weierstrass profile.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --loads 0.01:1:5        one profile, as JSON
    weier plot -D 1.25 --gamma 5 -m 3 curves.png               its curves by several methods
    weier plan -D 1.25 --gamma 5 -m 3 --tolerance 1e-4         methods that reach a tolerance
    weier solve -D 1.25 --gamma 5 -m 3 --method planned        curves within a tolerance
    snakemake --cores 2 --config scenes=minimal                a scene, in a checkout

    Completion of commands and options, for this shell or in ~/.bashrc (zsh_source, fish_source for others):

    \b
    eval "$(_WEIER_COMPLETE=bash_source weier)"
    """  # noqa: D301 - click wants the character


for module in (profile, plan, scene, measure):
    for command in module.COMMANDS:
        cli.add_command(command)


def main() -> None:
    """Run the command line; bad input and failed solves end in one sentence and exit code 1."""
    announce_compiling(lambda: click.echo("compiling, once for this installation: up to a minute", err=True))
    try:
        cli(prog_name="weier")
    except MemoryError:
        _stop("not enough memory: ask for fewer points, loads or cases")
    except (ValueError, ConvergenceError, OSError) as error:
        _stop(" ".join(str(error).split()))


def _stop(why: str) -> NoReturn:
    print(f"weier: {why}", file=sys.stderr)
    sys.exit(1)
