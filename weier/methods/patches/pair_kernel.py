"""The kernel of the sums over pairs of points, for many distances at a time.

The sine and the logarithm are their series, in loops without a call or a branch, which the compiler turns into
operations on four or eight numbers at once: that is three times as fast as the functions of the library, in which
most of the time would be spent.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel

# 2 sin(pi u)/u in powers of u^2: for |u| <= 1/2, the next term is below 1e-16 of the whole.
SINE = tuple(
    float(2 * (-1) ** k * np.pi ** (2 * k + 1) / np.prod(np.arange(1.0, 2 * k + 2))) for k in range(11)
)  # fmt: skip
MANTISSA = (1 << 52) - 1  # the bits of a double behind its sign and exponent
BIAS = 1023  # of the exponent
EXPONENT_OF_ONE = BIAS << 52
ROOT_OF_2, LN_2 = 2.0**0.5, float(np.log(2.0))


@kernel
def apply_kernel(d: Array, period: float, dual: bool) -> None:
    """Replace distances d by ln|2 sin(pi d/L)| or, dual, 1/sin^2(pi d/L); by 0 where d = 0."""
    for i in range(d.size):
        u = d[i] / period
        u -= np.floor(u + 0.5)
        q, series = u * u, SINE[10]
        series = SINE[8] + q * (SINE[9] + q * series)
        series = SINE[5] + q * (SINE[6] + q * (SINE[7] + q * series))
        series = SINE[2] + q * (SINE[3] + q * (SINE[4] + q * series))
        d[i] = abs(u * (SINE[0] + q * (SINE[1] + q * series)))
    if dual:
        for i in range(d.size):
            d[i] = 4 / (d[i] * d[i]) if d[i] > 0 else 0.0
    else:
        take_logarithms(d)


@kernel
def take_logarithms(x: Array) -> None:
    """Replace x >= 0 by ln x, and 0 by 0.

    With x = 2^k m and m between 1/sqrt(2) and sqrt(2), ln m = 2 artanh s with s = (m-1)/(m+1), |s| < 0.172.
    """
    exponent, mantissa = np.empty(x.size), np.empty(x.size)
    bits, mantissa_bits = x.view(np.int64), mantissa.view(np.int64)
    for i in range(x.size):
        exponent[i] = (bits[i] >> 52) - BIAS
        mantissa_bits[i] = (bits[i] & MANTISSA) | EXPONENT_OF_ONE
    for i in range(x.size):
        large = mantissa[i] > ROOT_OF_2
        m = 0.5 * mantissa[i] if large else mantissa[i]
        k = exponent[i] + 1 if large else exponent[i]
        s = (m - 1) / (m + 1)
        q = s * s
        series = 1 / 15 + q * (1 / 17 + q * (1 / 19 + q * (1 / 21 + q / 23)))
        series = 1 / 7 + q * (1 / 9 + q * (1 / 11 + q * (1 / 13 + q * series)))
        series = 1 + q * (1 / 3 + q * (1 / 5 + q * series))
        x[i] = k * LN_2 + 2 * s * series if x[i] > 0 else 0.0
