"""Products with a circulant matrix inside numba kernels, without allocation."""

from __future__ import annotations

from weier.kernels.arrays import Array
from weier.kernels.interruption import stop_if_asked
from weier.kernels.jit import kernel
from weier.kernels.transform import Spectrum, backward, forward


@kernel
def circulant_product(eigenvalue: Array, x: Array, spectrum: Spectrum, product: Array) -> None:
    """Multiply x by the symmetric circulant matrix with these eigenvalues: one pair of FFTs."""
    stop_if_asked()
    forward(x, spectrum)
    for k in range(spectrum.size):
        spectrum[k] *= eigenvalue[k]
    backward(spectrum, product)
