"""The two kinds of segments, contacts and gaps, and the limits that they share.

`contacts.CONTACTS` and `gaps.GAPS` have the same attributes and methods, and do not differ in anything else.
The density on contacts is the pressure, and the residual, which vanishes on them, is the gap. The density on gaps is
their slope, whose integral is the gap, and the residual is the pressure. Kernels take the numbers of a kind.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Union

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Indices

if TYPE_CHECKING:  # These modules import this one.
    from weier.methods.patches.contacts import Contacts
    from weier.methods.patches.gaps import Gaps

EPS = float(np.finfo(float).eps)
# largest half-width b of a thin gap over its distance l to the nearest edge: their interaction changes the rise of R
# by the crack by a relative 4 (b/l)^2 = 1.6e-7; contacts next to wider gaps need 15/(4 b/r)^(1/2) nodes for twelve
# digits, at most 750 at the half of it from which existing contacts are merged
MAX_THINNESS = 2e-4
# tension over the largest pressure at which a contact is cut: it affects the resistance to first order and the
# compliance to second order
MAX_TENSION = 1e-9
# Relative rounding of fields: of tensions, over the largest pressure of their contact or the load; of gaps, over the
# sum of the amplitudes; of singularities, over min(w, 1), with w the displacement under the whole load. Fields of
# shifted profiles differ by less (tests/methods/patches/test_pressure_and_gap.py). Singularities near births and
# mergers do not fall below it.
FIELD_ROUNDING = 1e-13
# largest relative tolerance of the residual: 1e-4 saves no more time, and a loose one may insert a gap whose edges it
# cannot determine, which then vanishes again; also that for the nodes of the first step, which leaves edges off by
# thousandths on any nodes, and the largest residual of boundary elements for a guess, in g_0
MAX_TOLERANCE = 1e-5
# Ratio of the half-width a of a new contact to the half-width c of the overlap that it replaces: Hertz's contact
# alone in a period has a = c (2/(1 + 2 ln(L/(pi a))))^(1/2), which is c/2 for L = 104 a, and c/4 to c for L = 5 a to
# 2e7 a. With a = sqrt(2) c it would carry no force.
NEW_CONTACT_WIDTH = 0.5

# A function of positions on contacts: indices of contacts, shape (n,), and their coordinates t, shape (n, points)
OnContacts = Callable[[Indices, NDArray[np.float64]], NDArray[np.float64]]

Kind = Union["Contacts", "Gaps"]
KindNumbers = tuple[bool, int, int, float, float, float, float, float]


@lru_cache
def numbers_of(kind: Kind, period: float) -> KindNumbers:
    """Return the numbers of a kind in a plain tuple, for kernels."""
    at_edges, factor = (kind.right_sign, kind.curvature_k_0), kind.factor(period)
    return kind.is_slope, kind.shift, kind.derivative, kind.hankel_sign, factor, kind.offset, *at_edges
