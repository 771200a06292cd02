"""Figures that cannot be drawn, or whose curves could not be distinguished, are refused before a solution."""

import re

import pytest
import yaml

from weier import figures
from weier.figures import scene_checks
from weier.scene import SceneError


def write(folder, product=None, other_studies=None, without="", **figure):
    fixed = {"D": 1.5, "gamma": 2, "m": 2}
    text = {
        "title": "test",
        "loads": [0.1, 1.0],
        "methods": ["layer", "bem"],
        "studies": {"one": {"product": fixed | (product or {})}} | (other_studies or {}),
        "figures": {"f": {"draw": "compliance", "studies": ["one"]} | figure},
    }
    text["figures"]["f"].pop(without, None)
    path = folder / "scene.yaml"
    path.write_text(yaml.safe_dump(text))
    return path


SWEEP = {"D": [1.2, 1.5], "gamma": [2, 3], "m": [1, 2], "seed": [0, 1]}
FREE = {"median over": ["D", "m", "seed"], "colour": "gamma"}
ANOTHER = {"two": {"product": {"D": 1.5, "gamma": 2, "m": 2}, "settings": {"bem": {"points_per_wave": 16}}}}
MISTAKES = [
    ({"draw": "style"}, "f.draw: a figure of studies must be one of .*, got 'style'"),
    ({"without": "studies"}, "f.studies: Field required: the studies that the figure shows"),
    ({"draw": "contact_tree"}, "f.draw: contact_tree needs contact_edges: true"),
    (
        {"draw": "profiles", "colour": "gamma"},
        "f: profiles takes no colour.*or draw compliance or contact_fraction or r",
    ),
    # A figure with two D, coloured by gamma, would draw two lines of each colour.
    ({"product": SWEEP, "colour": "gamma", "facet": "m"}, "f: D and seed vary .*: add D to colour, facet or median"),
    ({"product": {"phases": [1.0, 2.0]}, "facet": "method"}, "f: phases varies .*: add phases to"),
    ({"studies": ["one", "two"], "other_studies": ANOTHER}, "f: the settings of bem differ between these studies"),
]


@pytest.mark.parametrize(("figure", "said"), MISTAKES)
def test_figures_that_cannot_be_drawn_are_reported(figure, said, tmp_path):
    path = write(tmp_path, **figure)
    with pytest.raises(SceneError, match=rf"^{re.escape(str(path))}, line \d+: figures.{said}"):
        scene_checks.load_scene(path)


SOUND = [
    *[{"draw": kind} for kind in figures.KINDS if kind not in ("contact_tree", "borodich_galanov")],
    {"product": {"seed": [*range(9)]}},  # a median over phases alone, by default
    {"product": {"D": [1.2, 1.5], "gamma": [2, 3]}},  # as many panels
    {"product": SWEEP} | FREE,
    {"product": {"m": [1, 2], "phases": 1.0}, "colour": "m"},  # whose phases are the same
    {"title": r"$\gamma = 2$ and 5 \$"},
]


@pytest.mark.parametrize("figure", SOUND, ids=str)
def test_what_can_be_drawn_is_not_refused(figure, tmp_path):
    scene_checks.load_scene(write(tmp_path, **figure))
