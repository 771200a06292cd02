"""Pressure and gap of one wave by Westergaard (10), in its wavelength, amplitude and full-contact pressure."""

import numpy as np


def pressure(x, xi):
    """The pressure at x under a mean pressure xi."""
    s, c = _sine_and_cosine(x)
    return 2 * c * np.sqrt(np.maximum(xi - s**2, 0)) if xi < 1 else xi + (c - s) * (c + s)


def gap(x, xi):
    """The gap at x: outside the contact the root of (10) is imaginary and the slope of the gap."""
    s, _ = _sine_and_cosine(x)
    root = np.sqrt(np.maximum(s**2 - xi, 0))
    return 2 * (s * root - xi * np.arcsinh(root / np.sqrt(xi)))


def _sine_and_cosine(x):
    angle = np.pi * np.abs(x - np.rint(x))
    return np.sin(angle), np.cos(angle)
