"""Fourier transforms in kernels: numpy's, which `weier.kernels.compiler` replaces by others that allocate nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array

Spectrum = NDArray[np.complex128]


def forward(x: Array, spectrum: Spectrum) -> None:
    """Write the transform of x, shape (n,), into the spectrum, shape (n//2 + 1,)."""
    spectrum[:] = np.fft.rfft(x)


def backward(spectrum: Spectrum, x: Array) -> None:
    """Write what has this spectrum, shape (n//2 + 1,), into x, shape (n,); the spectrum may be overwritten."""
    x[:] = np.fft.irfft(spectrum, x.size)
