"""slippy's own solver in slippy's own environment: reads requests from standard input, answers on standard output.

Run by another interpreter, so it imports nothing of weier. A request is a pickled tuple of a name and arguments.
"""

from __future__ import annotations

import pickle
import sys
from array import array
from time import process_time
from typing import Any

import numpy as np


class PolonskyKeer:
    """slippy's conjugate gradients on a row of cells, its own circular convolution counted as pairs of FFTs."""

    def begin(self, height: Any, eigenvalue: Any) -> None:
        """Set the heights at the nodes and the displacement per pressure of each wave, as in numpy.fft.rfft."""
        from slippy.core.influence_matrix_utils import plan_convolve

        self.gap = (max(height) - np.array(height))[np.newaxis]
        matrix = np.zeros_like(self.gap)
        matrix[0, : len(eigenvalue)] = eigenvalue
        self.convolve = plan_convolve(self.gap, matrix, None, True)

    def product(self, pressure: Any) -> Any:
        """Return the displacement."""
        self.pairs += 1
        return self.convolve(pressure)

    def solve(self, load: float, start: Any, tolerance: float, most: int) -> tuple[Any, int, bool]:
        """Return the nodal pressure, the pairs of FFTs, and whether slippy reports convergence."""
        from slippy.core.influence_matrix_utils import polonsky_and_keer

        self.pairs = 0
        begin = np.ones_like(self.gap) if start is None else np.array(start)[np.newaxis]
        failed, pressure, _ = polonsky_and_keer(
            self.product, begin, self.gap, load * self.gap.size, 1.0, eps_0=tolerance, max_it=most
        )
        return array("d", pressure[0].tobytes()), self.pairs, not failed


def version() -> str:
    """Import slippy and return its version."""
    import slippy

    slippy.CUDA, slippy.CORES = False, 1
    return str(slippy.__version__)


def processor_seconds() -> float:
    """Return the processor seconds of this process so far."""
    return process_time()


def serve() -> None:
    """Answer until the input ends."""
    # slippy prints to standard output, which must carry the answers alone.
    answers, sys.stdout = sys.stdout.buffer, sys.stderr
    solver = PolonskyKeer()
    requests = {
        "version": version,
        "begin": solver.begin,
        "solve": solver.solve,
        "processor_seconds": processor_seconds,
    }
    while True:
        try:
            name, arguments = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        pickle.dump(requests[name](*arguments), answers, protocol=4)
        answers.flush()


if __name__ == "__main__":
    serve()
