"""Which methods reach a tolerance, and at what cost, for one profile or a scene: `weier plan`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import weier
from weier.cli.options import FILE, LOADS, OF_SERIES, loads_option, parameters, parse_loads
from weier.kernels.arrays import Array
from weier.methods.plan_part import QUANTITIES
from weier.methods.registry import PLANNED
from weier.pipeline.progress import waiting
from weier.scene import Case
from weier.surface.loads import check_range

PRESSURES = loads_option(None, f"Mean pressures, as for `weier solve`  [default: those of the scene, or {LOADS}].")


@click.command(params=[*OF_SERIES, PRESSURES])
@click.argument("scene_file", metavar="[SCENE]", required=False, type=FILE)
@click.option(
    "--tolerance",
    type=float,
    help="Largest error: of the compliance in g_0, of the resistance relative to the larger of itself and "
    "1 g_0/p_0*  [default: that of the scene, or 1e-3].",
)
@click.option(
    "--quantity",
    type=click.Choice(QUANTITIES),
    help="Which of the two has to be that accurate  [default: that of the scene, or compliance].",
)
def plan(
    scene_file: Path | None, loads: Array | None, tolerance: float | None, quantity: str | None, **series: Any
) -> None:
    """Show which methods reach a tolerance, and at what cost.

    The plan is for one profile, or for each case of a scene. It names the cheapest methods, load by load, with their
    errors, seconds and memory. Nothing is solved. For measured heights, take the series that weier.fit finds.

    \b
    weier plan -D 1.25 --gamma 5 -m 3 --phases 0,1,2 --tolerance 1e-4
    weier plan -D 1.5 --gamma 2 -m 6 --loads 1e-3:4:40 --tolerance 0.01 --quantity resistance
    weier plan -D 1.1 --gamma 5 -m inf --loads 0.1,1
    weier plan config/scenes/planned.yaml
    weier plan config/scenes/planned.yaml --tolerance 1e-2
    """  # noqa: D301 - click wants the character
    given = any(value is not None for value in series.values())
    if given == (scene_file is not None):
        raise click.UsageError(
            f"a plan is of a SCENE or of a profile (-D, --gamma, -m), got {'both' if given else 'neither'}"
        )
    with waiting("planning"):
        if scene_file is None:
            case = Case(parameters(series), (PLANNED,), {})
            case.check()
            loads = parse_loads(LOADS) if loads is None else loads
            check_range(loads)
        subject = case.profile if scene_file is None else weier.load_scene(scene_file)
        found = weier.plan(subject, loads, tolerance, quantity)
    click.echo(found)
