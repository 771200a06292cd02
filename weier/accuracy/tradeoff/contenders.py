"""What competes: the methods, each with the settings that trade accuracy for time."""

from __future__ import annotations

from weier.methods import registry
from weier.methods.method import Variant
from weier.theory.profile import Profile

REFERENCE = "patches 1e-12"


def contenders(profile: Profile) -> list[Variant]:
    """All that can be run on a profile with a finite number of terms; the reference comes last."""
    applicable = [method for method in registry.METHODS if method.takes(profile)]
    return [variant for method in applicable for variant in method.named_variants(profile)]
