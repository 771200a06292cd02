# Scenes by name, and what is made of them.
from functools import cache
from pathlib import Path

from weier.data import dataset
from weier import scene as scenes


@cache
def scene(name):
    return scenes.named(name)


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
