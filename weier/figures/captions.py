"""What each kind of figure shows, in the words under it on a page: plain text with the paper's symbols."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import NamedTuple

from weier.figures.style import PANELS
from weier.methods.registry import method_named, numerical_names
from weier.pipeline.curves import ESTIMATES
from weier.scene import Scene

# Where all methods stand beside each other, {drawn} tells them apart.
CAPTIONS = {
    "borodich_galanov": (
        "Bounds on the stiffness, and with it the conductance, of the self-similar punch of Borodich and "
        "Galanov over its roughness (Appendix B). Both meet at the smooth punch; the upper one grows without "
        "limit."
    ),
    "compliance": (
        "Compliance over mean pressure{drawn}. All curves of one profile meet at full contact, h = sum g_n."
    ),
    "contact_tree": (
        "The profile and, below it, where it touches over mean pressure: contacts are born as points, grow, and "
        "merge until all is one."
    ),
    "convergence": (
        "The infinite series: estimates with ever more terms resolved lie within the bounds, which hold for "
        "whatever phases the other terms have; both converge as terms are resolved."
    ),
    "extremes": (
        "Correct digits of the compliance of one profile, by every method, over all loads a number can hold; and "
        "how the condition numbers of the boundary elements' equations grow with the number of nodes."
    ),
    "phases": (
        "What the phase between the waves changes: compliance over mean pressure for each phase, dashed, from "
        "light (in phase) to dark (in antiphase), and the average as a solid line. All curves meet at full "
        "contact."
    ),
    "profiles": "The profiles over two of their longest waves.",
    "resistance": (
        "Contact resistance over mean pressure{drawn}. At each birth and merger of contacts the exact curve has a "
        "kink."
    ),
    "truncated_compliance": (
        "What further terms change in the compliance, counted from the mean plane that series of all lengths "
        "share. The band holds the endless series, whatever its further phases (27)."
    ),
    "truncated_resistance": (
        "What further terms change in the contact resistance. The band holds the endless series, whatever its "
        "further phases."
    ),
    "work_precision": (
        "Seconds a load against the largest error over the loads: a dot a profile, a marker the median of a "
        "method at one setting, and a band along those that nothing beats in both."
    ),
}


class Caption(NamedTuple):
    """Of one figure: its name for people, the words below it, and what it is to who cannot see it."""

    name: str
    text: str
    alternative: str


def caption(scene: Scene, name: str) -> Caption:
    """The caption of a figure of a scene: its title, if any, and what its kind shows of these studies."""
    figure = scene.figure_named(name)
    methods = [case.methods for study in figure.studies for case in scene.study_named(study)]
    shows = CAPTIONS[figure.draw].format(drawn=_drawn(methods))
    named = name.replace("_", " ").capitalize()
    subject, *_ = re.split(r"[:.;] ?", shows)
    return Caption(named, " ".join(filter(None, [figure.title and f"{figure.title}.", shows])), f"{named}: {subject}")


def _drawn(cases: Sequence[Collection[str]]) -> str:
    """How methods are told apart where all stand beside each other; cases by their methods."""
    if len(cases) > PANELS:
        return ": a thin line for each profile, and a thick one for the median of each method"
    methods = {method for case in cases for method in case}
    numerical = [method_named(method).label for method in numerical_names() if method in methods]
    looks = ("as a solid black line", "as circles")  # of the more accurate first
    estimates = ["the estimates in colours"] * bool(methods.intersection(ESTIMATES))
    words = [*estimates, *(" ".join(each) for each in zip(numerical, looks, strict=False))]
    return "".join([": " * bool(words), ", ".join(words)])
