"""Provenance of a file: the attributes of the Attribute Convention for Data Discovery (ACDD 1.3).

Dates are the date of the run. If the environment sets SOURCE_DATE_EPOCH, it replaces them, and the same scene
and program write the same bytes.
"""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from functools import cache

from weier.digests import PACKAGE, versions

NORMALISED = (
    "Lengths along x are in lambda_0, heights, gaps and compliance in g_0, pressures in p_0* = 2 pi M g_0/lambda_0, "
    "and resistance, dh/dp, in g_0/p_0*."
)
PAPER = (
    "M. Ciavarella, G. Murolo, G. Demelio, J. R. Barber, Elastic contact stiffness and contact resistance for the "
    "Weierstrass profile, J. Mech. Phys. Solids 52 (2004) 1247-1265, doi:10.1016/j.jmps.2003.12.002"
)
VERSION = "0.1.0"

# The attributes that all files have in common.
FIXED = {
    "Conventions": "CF-1.11, ACDD-1.3",
    "comment": "The units of values are in their attributes: `normalised_by` may name one where `units` is 1. Values "
    "in SI units are for the two bodies whose moduli and resistivities or conductivities are attributes.",
    "summary": "Elastic compliance and electrical contact resistance against mean pressure of Weierstrass or "
    "measured profiles pressed on a plane: closed-form estimates, numerical solutions, and bounds, by method.",
    "keywords": "contact mechanics, contact resistance, contact stiffness, rough surface, Weierstrass profile",
    "references": PAPER,
    "license": "MIT",
    "creator_name": "The weier developers",
    "program": "weier",
    "product_version": VERSION,
}


def attributes(title: str, step: str, scene: str = "", in_si: bool = False) -> dict[str, str]:
    """Return global attributes of a file by its title, the step that made it, the text of its scene and its units."""
    date = run_date()
    changing = {
        "title": title,
        "source": f"numerical model: {origin()}",
        "history": f"{step} by weier {VERSION}",
        "git_commit": commit() or "unknown: not run from a checkout",
        "date_created": date,
    }
    units = {} if in_si else {"normalisation": NORMALISED}
    return FIXED | units | changing | ({"scene": scene} if scene else {})


def source_date() -> str:
    """Return SOURCE_DATE_EPOCH, or ""; if it is set, files contain nothing that differs between runs."""
    return os.environ.get("SOURCE_DATE_EPOCH", "")


def run_date() -> str:
    """Return the date of this run, or SOURCE_DATE_EPOCH, in ISO 8601."""
    epoch = source_date()
    date = datetime.fromtimestamp(int(epoch), UTC) if epoch else datetime.now(UTC)
    return date.isoformat(timespec="seconds")


def result_attributes() -> dict[str, str]:
    """Return the provenance attributes of a result in memory."""
    return {"program": FIXED["program"], "source": origin(), "normalisation": NORMALISED, "references": PAPER}


@cache
def origin() -> str:
    """Return the program, the packages and the kind of processor of this process in one line."""
    program = f"weier {VERSION}" + (f" at {commit()}" if commit() else "")
    return f"{program}, {versions()}, Python {platform.python_version()}, {platform.machine()}"


@cache
def commit() -> str:
    """Return the commit of the checkout, with a note on uncommitted changes; empty outside a checkout."""
    if not (PACKAGE.parent / ".git").exists():  # A parent repository, in which weier is installed, does not count.
        return ""
    import subprocess  # few processes need it

    git = ["git", "-C", str(PACKAGE.parent), "--no-optional-locks"]
    described = ["describe", "--always", "--abbrev=40", "--exclude=*", "--dirty= with changes"]
    try:
        return subprocess.run([*git, *described], capture_output=True, text=True, timeout=20).stdout.strip()
    except (OSError, subprocess.TimeoutExpired):
        return ""
