"""What each kind of figure shows, in the words under it on a page: plain text with the paper's symbols."""

CAPTIONS = {
    "borodich_galanov": (
        "Bounds on the stiffness, and with it the conductance, of the self-similar punch of Borodich and "
        "Galanov over its roughness (Appendix B). Both meet at the smooth punch; the upper one grows without "
        "limit."
    ),
    "compliance": (
        "Compliance over mean pressure: the estimates, and the numerical solutions as a solid line and points. "
        "All curves of one profile meet at full contact, h = sum g_n."
    ),
    "contact_tree": (
        "The profile and, below it, where it touches over mean pressure: contacts are born as points, grow, and "
        "merge until all is one."
    ),
    "endless": (
        "The endless series: estimates with ever more terms resolved lie within the bounds, which hold whatever "
        "the terms left out; both close in as terms are resolved."
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
        "Contact resistance over mean pressure: the estimates, and the numerical solutions as a solid line and "
        "points. At each birth and merger of contacts the exact curve has a kink."
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


def caption(kind: str, name: str, title: str = "") -> tuple[str, str]:
    """The name of a figure for people, and the words below it: its title, if any, and what its kind shows."""
    return name.replace("_", " ").capitalize(), " ".join(filter(None, [title and f"{title}.", CAPTIONS[kind]]))
