"""What competes: the methods, each with the settings that trade accuracy for time."""

from __future__ import annotations

from weier.methods.variant import Contender
from weier.theory.profile import Profile

REFERENCE = "patches 1e-12"

ESTIMATES = ("archard", "demelio")
LAYER_POINTS = (6, 12, 24, 48)
# Points for each of the finest waves: from the paper's 12 to 10^5. Halved, they stay whole.
POINTS_PER_WAVE = (12, 24, 48, 96, 192, 384, 768, 1536, 6144, 98304)
MOST_COMPARED_POINTS = 100_000  # in one period
RESIDUALS = (1e-2, 1e-4, 1e-6)  # beside the default 1e-10, on 96 points a wave
RESIDUAL_POINTS = 96
PATCH_TOLERANCES = (1e-6, 1e-8, 1e-10, 1e-12)  # they set the nodes of each contact


def contenders(profile: Profile) -> list[Contender]:
    """All that can be run on a profile with a finite number of terms; the reference comes last."""
    waves = profile.wavenumber[-1]
    grids = [count for count in POINTS_PER_WAVE if count * waves <= MOST_COMPARED_POINTS]
    return [
        *(Contender(name, name, {}) for name in ESTIMATES),
        *(Contender(f"layer {points}", "layer", {"points": points}) for points in LAYER_POINTS),
        *(Contender(f"bem {count}", "bem", {"points": count * waves}) for count in grids),
        *(_stopped_early(residual, waves) for residual in RESIDUALS),
        Contender(f"bem {RESIDUAL_POINTS} h", "bem", {"points": RESIDUAL_POINTS * waves, "resistance": False}),
        *(Contender(f"patches {limit:.0e}", "patches", {"tolerance": limit}) for limit in PATCH_TOLERANCES),
    ]


def _stopped_early(residual: float, waves: int) -> Contender:
    settings = {"points": RESIDUAL_POINTS * waves, "tolerance": residual}
    return Contender(f"bem {RESIDUAL_POINTS} {residual:.0e}", "bem", settings)
