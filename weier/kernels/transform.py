"""Fourier transforms in kernels: those of numpy, and in compiled code those of rocket-fft that allocate nothing."""

from __future__ import annotations

from functools import cache
from typing import Any

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


@cache
def register_transforms() -> None:
    """Tell numba how to compile both."""
    from numba.extending import overload
    from rocket_fft import c2r, r2c

    axes = np.zeros(1, np.int64)  # along which to transform: made here, since in a kernel each product would do so

    @overload(forward, strict=False)
    def _forward(x: Any, spectrum: Any) -> Any:
        return lambda x, spectrum: r2c(x, spectrum, axes, True, 1.0, 1)

    @overload(backward, strict=False)
    def _backward(spectrum: Any, x: Any) -> Any:
        return lambda spectrum, x: c2r(spectrum, x, axes, False, 1.0 / x.size, 1)
