"""The command line: its commands read arguments and call the same functions as the Python interface.

May use all other folders of weier, and none of them uses it.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import click

from weier.data.provenance import VERSION
from weier.kernels.jit import announce_compiling
from weier.methods.errors import ConvergenceError

# The commands of each module, in the order of the help, and those that only the pipeline calls.
COMMANDS = {
    "profile": ("solve", "plot"),
    "plan": ("plan",),
    "table": ("table",),
    "scene": ("compile", "batch", "figures", "claims", "page"),
    "measure": ("tradeoff", "convergence", "extremes", "draw"),
}
HIDDEN = {*COMMANDS["scene"], *COMMANDS["measure"]} - {"compile"}
EXTRA = {"bokeh", "jinja2", "jsonschema", "snakemake"}  # of scenes and their pages: `pip install weier` has none
EXIT = (
    "Exit codes: 0 done; 1 bad input or a solver that missed its tolerance, told in one sentence; 2 wrong usage; "
    "130 stopped by Ctrl-C."
)


HELP = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


@click.group(context_settings=HELP, epilog=EXIT)
@click.version_option(VERSION)
def cli() -> None:
    """Contact stiffness and contact resistance of the Weierstrass profile.

    \b
    weier solve -D 1.25 --gamma 5 -m 3 --loads 0.01:1:5        one profile, as JSON
    weier plot -D 1.25 --gamma 5 -m 3 curves.png               its curves by several methods
    weier plan -D 1.25 --gamma 5 -m 3 --tolerance 1e-4         methods that reach a tolerance
    weier solve -D 1.25 --gamma 5 -m 3 --method planned        curves within a tolerance
    weier solve --trace shaft.csv --loads 0.01:1:5             measured heights
    weier table results/paper/contact.nc curves.csv            curves for a spreadsheet
    snakemake --cores 2 --config scenes=minimal                a scene, in a checkout

    Completion of commands and options, for this shell or in ~/.bashrc (zsh_source, fish_source for others):

    \b
    eval "$(_WEIER_COMPLETE=bash_source weier)"
    """  # noqa: D301 - click wants the character


class Command(click.Command):
    """A command whose module is imported when it is called: the list of all of them is there at once."""

    def __init__(self, module: str, name: str, summary: str) -> None:
        super().__init__(name, short_help=summary, hidden=name in HIDDEN)
        self._module = module

    @property
    def loaded(self) -> click.Command:
        """The command itself."""
        command: click.Command = getattr(import_module(f"{__name__}.{self._module}"), str(self.name))
        return command

    def make_context(self, *arguments: Any, **options: Any) -> click.Context:
        """The context of the command itself, in which it runs."""
        return self.loaded.make_context(*arguments, **options)


def _summaries(module: str) -> dict[str, str]:
    """The first line of each function's docstring in a module of commands, from its text."""
    tree = ast.parse(Path(__file__).with_name(f"{module}.py").read_text(encoding="utf-8"))
    functions = [statement for statement in tree.body if isinstance(statement, ast.FunctionDef)]
    return {each.name: (ast.get_docstring(each) or "").partition("\n")[0] for each in functions}


for _module, _names in COMMANDS.items():
    _lines = _summaries(_module)
    for _name in _names:
        cli.add_command(Command(_module, _name, _lines[_name]))


def main() -> None:
    """Run the command line; bad input and failed solves end in one sentence and exit code 1."""
    announce_compiling(_say_compiling())
    try:
        sys.exit(cli(prog_name="weier", standalone_mode=False))
    except click.Abort:  # which click makes of Ctrl-C, and standing alone ends with exit code 1
        raise KeyboardInterrupt from None
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except ModuleNotFoundError as error:
        if str(error.name).partition(".")[0] not in EXTRA:
            raise
        _stop(
            f"this command needs {error.name}: pip install 'weier[pipeline]', or requirements/run.txt of a checkout"
        )
    except MemoryError:
        _stop("not enough memory: ask for fewer points, loads or cases")
    except (ValueError, ConvergenceError, OSError) as error:
        _stop(_told(error))


def _told(error: Exception) -> str:
    """An error in one line, but for that of a scene, which has a line for each mistake."""
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename} cannot be read or written: {error.strerror}"
    from weier.scene import SceneError  # only now, since it takes half a second

    return str(error) if isinstance(error, SceneError) else " ".join(str(error).split())


def _say_compiling() -> Callable[[str], None]:
    """What tells which method is compiled, once for each."""
    told: set[str] = set()

    def say(module: str) -> None:
        name = module.removeprefix("weier.methods.").partition(".")[0]
        if name not in told:
            click.echo(f"compiling {name}, once for all later runs", err=True)
        told.add(name)

    return say


def _stop(why: str) -> NoReturn:
    print(f"weier: {why}", file=sys.stderr)
    sys.exit(1)
