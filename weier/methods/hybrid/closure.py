"""The layer that stands for all finer terms, as a law of one number s at every node."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need
from numpy.typing import NDArray

from weier.methods import layer
from weier.theory.profile import Profile

Array = NDArray[np.float64]

SUBDIVISION = 8  # of the layer's own table: between its rows ln p as a cubic in ln s is as good as that table
HEAVIEST = 1e3  # mean pressure in p_0*


class Law(NamedTuple):
    """The layer at a node of self-influence c: ln p over ln(w + c p), and c."""

    log_pressure: scipy.interpolate.CubicHermiteSpline
    stiffness: float


class Node(NamedTuple):
    """Pressure, compression or negative gap, and their slopes, at every s."""

    pressure: Array
    compression: Array
    pressure_slope: Array
    compression_slope: Array


def law_of(kept: Profile, stiffness: float) -> Law:
    """The tail's layer, in the units of the first wave."""
    D, gamma, n = kept.D, float(kept.gamma), kept.terms
    peaks = 1 / math.expm1((D - 1) * math.log(gamma))  # of all resolved waves in full contact, in p_k*, at most
    log_xi, log_W, power = layer.tail_table(D, gamma, HEAVIEST + peaks, SUBDIVISION)
    compression, pressure = gamma ** ((D - 2) * n) * np.exp(log_W), gamma ** ((D - 1) * n) * np.exp(log_xi)
    s = compression + stiffness * pressure
    slope = s / (power * compression + stiffness * pressure)  # d ln p/d ln s
    log_pressure = scipy.interpolate.CubicHermiteSpline(np.log(s), np.log(pressure), slope)
    return Law(log_pressure, stiffness)


def state_of_nodes(s: Array, law: Law) -> Node:
    """What the law says at every s, shape (N,): outside contact, s <= 0, there is no pressure."""
    inside = s > 0
    log_s = np.log(np.where(inside, s, 1.0))
    near = np.clip(log_s, *law.log_pressure.x[[0, -1]])
    slope = law.log_pressure(near, 1)
    p = np.where(inside, np.exp(law.log_pressure(near) + slope * (log_s - near)), 0.0)
    p_slope = np.where(inside, slope * p / np.where(inside, s, 1.0), 0.0)
    return Node(p, s - law.stiffness * p, p_slope, 1 - law.stiffness * p_slope)
