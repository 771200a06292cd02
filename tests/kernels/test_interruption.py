"""Ctrl-C while a kernel returns, and for whoever handles it."""

import ctypes
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import pytest

from weier.kernels.interruption import interruptible, run_kernel

PATIENCE = 120  # seconds

pytestmark = pytest.mark.usefixtures("ctrl_c")

# Nothing but a kernel that returns a tuple of arrays, again and again.
KERNEL_ALONE = """
import time
import numpy as np
from weier.kernels.interruption import interruptible
from weier.methods.patches.pair_sums import make_pair_matrix

origin, offset = np.arange(30_000) / 30_000, np.zeros(30_000)

@interruptible
def endure():
    print("ready", flush=True)
    while True:
        make_pair_matrix(origin, offset, 1.0, False)

make_pair_matrix(origin, offset, 1.0, False)
try:
    endure()
except KeyboardInterrupt:
    print("stopped", flush=True)
"""


def test_a_kernel_is_not_interrupted_while_it_returns():
    """There numba would crash the process."""
    with subprocess.Popen([sys.executable, "-c", KERNEL_ALONE], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        try:
            said, _ = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    assert (said, process.returncode) == ("stopped\n", 0)


def test_a_function_is_as_it_was():
    @interruptible
    def ratio(a, *, b):
        """Divide."""
        return np.float64(a) / np.float64(b), signal.getsignal(signal.SIGINT)

    assert ratio.__doc__ == "Divide."
    before = signal.getsignal(signal.SIGINT)
    value, within = ratio(1.0, b=2.0)
    assert (value, within is before) == (0.5, False)
    assert signal.getsignal(signal.SIGINT) is before
    with ThreadPoolExecutor(1) as pool:  # where there is no Ctrl-C
        assert pool.submit(ratio, 1.0, b=2.0).result()[1] is before


def test_whoever_handles_ctrl_c_goes_on_to_do_so():
    seen = []
    signal.signal(signal.SIGINT, lambda *_: seen.append(True))
    try:
        assert interruptible(lambda: signal.raise_signal(signal.SIGINT) or 1)() == 1
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    assert seen == [True]


class Pair(NamedTuple):
    """What a kernel may return."""

    one: int


def test_ctrl_c_is_raised_once_the_kernel_has_returned():
    """Python code that is called by compiled code runs to its end."""
    ended = []

    def returning():
        signal.raise_signal(signal.SIGINT)
        ended.append(Pair(1))

    with pytest.raises(KeyboardInterrupt):
        interruptible(run_kernel)(returning, ())
    assert ended == [Pair(1)]
    assert run_kernel(lambda: 1, ()) == 1
    with pytest.raises(KeyboardInterrupt):  # and at once elsewhere
        interruptible(lambda: signal.raise_signal(signal.SIGINT))()


def test_ctrl_c_that_a_callback_loses_is_raised_after_the_next_kernel(monkeypatch):
    """As where LLVM calls Python: an exception cannot pass through C, which prints it and goes on."""
    lost = []
    monkeypatch.setattr(sys, "unraisablehook", lambda failure: lost.append(failure.exc_type))
    callback = ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        interruptible(lambda: (callback(), run_kernel(lambda: 1, ())))()
    with pytest.raises(KeyboardInterrupt):  # also where no kernel follows
        interruptible(callback)()
    assert lost == [KeyboardInterrupt] * 2
    assert interruptible(run_kernel)(lambda: 1, ()) == 1
