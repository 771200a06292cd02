"""A small trade, measured on coarse grids, for the tests of what is made of it."""

import pytest

from tests.scenes import scene_in
from weier.accuracy import tradeoff, variants

SCENE = """
title: Small
loads: [0.01, 0.1, 2.0]
methods: [patches]
studies:
  profiles:
    cases:
      - {D: 1.25, gamma: 5, m: 1}
      - {D: 1.5, gamma: 3, m: 2, phases: 1.0}
"""


def small_trade(folder, text=SCENE, max_points=800):
    """The trade of a scene, on grids of no more points than this."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(variants, "MAX_POINTS", max_points)
        return tradeoff.measure(scene_in(folder, text))
