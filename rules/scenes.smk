# Scenes by name, and what is made of them.
from functools import cache
from pathlib import Path

from weier import scene as scenes
from weier.data import dataset
from weier.figures import check_kinds
from weier.pipeline.claims import check_names


@cache
def scene(name):
    loaded = scenes.named(name)
    check_kinds(loaded)
    check_names(loaded)
    return loaded


def studies(wanted):
    return lambda w: expand("results/{{scene}}/studies/{s}.nc", s=wanted(w))


def products(name):
    kinds, path = ["pdf", "svg", "png"], f"results/{name}/figures/{{f}}.{{e}}"
    figures = expand(path, f=scene(name).figures, e=kinds)
    return [whole(f"results/{name}/contact.nc"), f"results/{name}/claims.md", *figures]


def whole(path):
    """Stop at a file that is cut short or of another program: where no job reads it, none would notice."""
    if Path(path).exists():
        dataset.open_lazily(path).close()
    return path
