"""Ctrl-C in the midst of a kernel, and what else threads could change."""

import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from weier.kernels import interruption
from weier.kernels.interruption import ask_to_stop, interruptible, stop_if_asked

PATIENCE = 120  # seconds

pytestmark = pytest.mark.usefixtures("ctrl_c")

# A solve of many minutes, after a short one that has compiled what it needs, and another short one after it.
PROGRAM = """
import threading, time
import numpy as np
import weier

def short():
    return weier.solve(weier.Profile(D=1.25, gamma=5, m=2), [0.1, 0.5], {method!r}).compliance.values

before = short()
weier.solve(weier.Profile(D=1.25, gamma=5, m={terms}), [0.5], {method!r})  # compiles what many contacts take
print("ready", flush=True)
try:
    weier.solve(weier.Profile(D=1.25, gamma=5, m={terms}), np.geomspace(1e-3, 4, 100), {method!r}{settings})
except KeyboardInterrupt:
    while threading.active_count() > 1:  # until the other thread has stopped, too
        time.sleep(0.02)
    print("stopped", (short() == before).all(), flush=True)
"""


@pytest.mark.parametrize(
    ("method", "terms", "settings"), [("bem", 3, ", points=4_000_000"), ("patches", 5, "")], ids=["bem", "patches"]
)
def test_ctrl_c_stops_a_solve_and_leaves_the_program_as_it_was(method, terms, settings):
    program = PROGRAM.format(method=method, terms=terms, settings=settings)
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(3)  # the solve is well under way
        process.send_signal(signal.SIGINT)
        try:
            said, _ = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    assert said == "stopped True\n"


# Nothing but a kernel that returns a tuple of arrays, again and again.
KERNEL_ALONE = """
import threading, time
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
    while threading.active_count() > 1:
        time.sleep(0.02)
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
        return np.float64(a) / np.float64(b), threading.current_thread()

    assert ratio.__doc__ == "Divide."
    value, thread = ratio(1.0, b=2.0)
    assert value == 0.5
    assert thread is not threading.current_thread()
    with np.errstate(divide="ignore"):  # which the other thread has to know: a warning would be an error here
        assert ratio(1.0, b=0.0)[0] == np.inf
    with pytest.raises(FloatingPointError), np.errstate(divide="raise"):
        ratio(1.0, b=0.0)
    with ThreadPoolExecutor(1) as pool:  # where there is no Ctrl-C
        _, thread = pool.submit(ratio, 1.0, b=2.0).result()
        assert thread is pool.submit(threading.current_thread).result()


def test_all_solves_of_a_process_stop_and_the_next_one_runs():
    started = threading.Barrier(3)

    @interruptible
    def endure():
        started.wait(PATIENCE)
        while True:
            stop_if_asked()
            time.sleep(0.01)

    with ThreadPoolExecutor(2) as pool:
        solves = [pool.submit(endure) for _ in range(2)]
        started.wait(PATIENCE)
        ask_to_stop()
        for solve in solves:
            with pytest.raises(InterruptedError):
                solve.result(PATIENCE)
    assert interruption.ASKED[0] == 0
    assert interruptible(lambda: 1)() == 1


def test_to_ask_where_nothing_is_solved_stops_nothing():
    ask_to_stop()
    assert interruptible(lambda: 1)() == 1


def test_a_solve_within_a_solve_stops_with_it():
    @interruptible
    def inner():
        ask_to_stop()
        return interruptible(stop_if_asked)()

    with pytest.raises(InterruptedError):
        inner()
    assert interruption.ASKED[0] == 0


def test_a_thread_that_ended_without_a_word_keeps_nobody_waiting():
    thread = threading.Thread(target=interruption._SOLVES.__enter__)  # as if interrupted while it was leaving
    thread.start()
    thread.join()
    ask_to_stop()
    assert interruption.ASKED[0] == 1
    assert interruptible(lambda: interruption.ASKED[0])() == 0
