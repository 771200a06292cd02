"""Products with a circulant matrix inside numba kernels, without allocation."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray
from rocket_fft import c2r, r2c

from weier.kernels.jit import kernel

Array = NDArray[np.float64]
Spectrum = NDArray[np.complex128]

AXES = np.zeros(1, np.int64)  # along which to transform: made here, since in a kernel each product would make it anew


def _forward(x: Array, spectrum: Spectrum) -> None:
    spectrum[:] = np.fft.rfft(x)


def _backward(spectrum: Spectrum, x: Array) -> None:
    x[:] = np.fft.irfft(spectrum, x.size)


# Compiled, the two write straight into their output; as plain Python they are numpy's.
@overload(_forward, strict=False)
def _compiled_forward(x: Any, spectrum: Any) -> Any:
    return lambda x, spectrum: r2c(x, spectrum, AXES, True, 1.0, 1)


@overload(_backward, strict=False)
def _compiled_backward(spectrum: Any, x: Any) -> Any:
    return lambda spectrum, x: c2r(spectrum, x, AXES, False, 1.0 / x.size, 1)


@kernel
def circulant_product(eigenvalue: Array, x: Array, spectrum: Spectrum, product: Array) -> None:
    """Multiply x by the symmetric circulant matrix with these eigenvalues: one pair of FFTs."""
    _forward(x, spectrum)
    for k in range(spectrum.size):
        spectrum[k] *= eigenvalue[k]
    _backward(spectrum, product)
