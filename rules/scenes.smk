# Scenes by name, and what is made of them.
import re
import sys
from functools import cache
from pathlib import Path

from weier.data.netcdf import check_whole
from weier.figures import checks, kinds
from weier.figures.captions import caption
from weier.scene import SceneError


@cache
def scene(name):
    try:
        return checks.load_by_name(name, CONFIG / "scenes")
    except SceneError as error:
        sys.exit(f"weier: {error}")  # else Snakemake adds a traceback


def scene_file(name):
    """The file of a scene, as jobs read it."""
    return str(CONFIG / "scenes" / f"{name}.yaml")


def caption_as_rst(name, figure):
    """The caption of a figure for Snakemake's report, whose markup would read p_0* as a link."""
    return re.sub(r"([*_`|\\])", r"\\\1", caption(scene(name), figure).text)


def in_checkout(*paths):
    """Paths of the checkout as they are called from the folder where Snakemake runs."""
    return [os.path.relpath(CHECKOUT / path) for path in paths]


def scene_names():
    """The scenes that the configuration names, separated by commas."""
    return [name.strip() for name in str(config["scenes"]).split(",")]


def batches(studies):
    """The files that hold the cases of some studies, of the scene that the wildcards name."""
    return lambda w: [
        f"results/{w.scene}/batches/{batch}.nc"
        for batch in scene(w.scene).batches_of(*studies(w))
    ]


def products(name):
    kinds, path = ["pdf", "svg", "png"], f"results/{name}/figures/{{f}}.{{e}}"
    drawn = expand(path, f=scene(name).figures, e=kinds)
    return [whole(f"results/{name}/contact.nc"), f"results/{name}/claims.md", *drawn]


def whole(path):
    """Stop at a file that is cut short or of another program: where no job reads it, none would notice."""
    if Path(path).exists():
        check_whole(path)
    return path
