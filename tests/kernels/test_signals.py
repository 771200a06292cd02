"""Signals at random moments: no call crashes or makes them wait, and the next solve has the same bits."""

import os
import signal
import subprocess
import sys

import pytest

from tests.marks import compiled

pytestmark = pytest.mark.usefixtures("ctrl_c")

# Each call is interrupted somewhere between its begin and its end; its seconds are measured without.
PROGRAM = """
import math, os, random, signal, sys, threading, time
import numpy as np
import weier
from weier.methods.registry import numerical_names

random.seed(int(sys.argv[2]))
LOADS = np.geomspace(1e-2, 2, 12)

def profile(m=4):
    return weier.Profile(D=1.4, gamma=3, m=m, phases=weier.random_phases(random.randrange(10**6)))

calls = {name: lambda name=name: weier.solve(profile(), LOADS, name) for name in numerical_names()}
calls["fields"] = lambda: weier.fields(profile(), 0.1)
calls["events"] = lambda: weier.events(profile(3), 0.05, 0.5)
calls["choice"] = lambda: weier.solve(weier.Profile(1.25, 5, math.inf), LOADS, tolerance=1e-2)
calls["several"] = lambda: weier.solve([profile(), profile()], LOADS, ["layer", "bem", "patches"])

def fixed():
    series = weier.Profile(D=1.25, gamma=5, m=3, phases=(0.0, 1.0, 2.0))
    return [weier.solve(series, LOADS, name).compliance.values.tobytes() for name in ("layer", "bem", "patches")]

def strike(call, seconds):
    sent = []

    def send():
        time.sleep(random.random() * seconds)
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    sender = threading.Thread(target=send)
    try:
        sender.start()
        call()
        sender.join()
        time.sleep(1.0)
    except KeyboardInterrupt:
        waited = time.perf_counter() - sent[0]
    sender.join()
    return waited

before, seconds = fixed(), {}
for name, call in calls.items():
    call()
    start = time.perf_counter()
    call()
    seconds[name] = max(time.perf_counter() - start, 0.01)
worst = dict.fromkeys(calls, 0.0)
for number in range(int(sys.argv[1])):
    name = list(calls)[number % len(calls)]
    worst[name] = max(worst[name], strike(calls[name], seconds[name]))
    if number % 20 == 19:
        assert fixed() == before
assert fixed() == before
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
print({name: round(wait, 3) for name, wait in worst.items()}, file=sys.stderr)
print(max(worst.values()))
"""


@compiled
def test_signals_end_any_call_soon_and_leave_nothing_behind():
    done = subprocess.run([sys.executable, "-c", PROGRAM, "20", "1"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) < 2, done.stderr  # seconds: no kernel takes longer than half a second


# Nothing but a kernel that returns arrays, for each of which numba runs Python.
KERNEL_ALONE = """
import os, random, signal, threading
import numpy as np
from weier.methods.patches.pair_sums import make_pair_matrix

origin, offset = np.arange(30_000) / 30_000, np.zeros(30_000)
make_pair_matrix(origin, offset, 1.0, False)
for _ in range(20):
    sender = threading.Timer(0.1 * random.random(), os.kill, (os.getpid(), signal.SIGINT))
    try:
        sender.start()
        while True:
            make_pair_matrix(origin, offset, 1.0, False)
    except KeyboardInterrupt:
        sender.join()
"""


@compiled
def test_signals_while_a_kernel_returns():
    subprocess.run([sys.executable, "-c", KERNEL_ALONE], check=True)


@compiled
def test_ctrl_c_ends_compiling_at_once(tmp_path):
    """Even where LLVM calls Python, which would ignore it."""
    command = [sys.executable, "-m", "weier", "compile", "bem"]
    fresh = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=fresh) as process:
        assert process.stderr.readline() == "compiling bem, once for all later runs\n"
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == -signal.SIGINT
