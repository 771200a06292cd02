"""The server that does the work of jobs: the same files and words as without it, and no imports in the jobs."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from weier.pipeline import server

PATIENCE = 120  # seconds

pytestmark = pytest.mark.usefixtures("ctrl_c")

SCENE = """
title: test
loads: [0.1, 1.0]
methods: [demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
figures:
  curves: {draw: compliance, studies: [one], title: A title}
"""
# A command that starts a server as the Snakefile does, tells where, and stays until its standard input ends.
HOLDER = """
import os, sys
from weier.pipeline import server
stop = server.start()
print(os.environ[server.ADDRESS], flush=True)
sys.stdin.read()
stop()
"""


@pytest.fixture(autouse=True)
def _dated(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")  # or the bytes of two files would differ by their dates


@pytest.fixture
def holder(_dated):
    """A process that has started a server, and the server's address."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    yield process, process.stdout.readline().strip()
    process.communicate(timeout=PATIENCE)


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "test.yaml"
    path.write_text(SCENE)
    return path


def job(folder, address, *arguments, python=()):
    """A job as a rule runs it, with these options of Python."""
    environment = os.environ | {server.ADDRESS: address, "PYTHONPATH": os.getcwd()}
    command = [sys.executable, *python, "-m", "weier", *arguments]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=PATIENCE)


BATCH = ("batch", "test.yaml", "one-0", "data.nc", "cost.nc")


def test_a_job_leaves_the_same_file_and_imports_nothing(holder, scene_file, tmp_path):
    done = job(tmp_path, holder[1], *BATCH, python=["-X", "importtime"])
    assert done.returncode == 0, done.stderr
    assert "solve test one-0" in done.stderr
    assert "numpy" not in done.stderr
    by_server = (tmp_path / "data.nc").read_bytes()
    done = job(tmp_path, "", *BATCH, python=["-X", "importtime"])
    assert "numpy" in done.stderr
    assert (tmp_path / "data.nc").read_bytes() == by_server


def test_a_figure_is_the_same_from_a_server_that_has_drawn_before(holder, scene_file, tmp_path):
    assert job(tmp_path, "", "batch", "test.yaml", "one-0", "batches/one-0.nc", "cost.nc").returncode == 0
    files = [f"curves.{suffix}" for suffix in ("pdf", "svg", "png")]
    for folder, address in (("served", holder[1]), ("alone", "")):
        done = job(tmp_path, address, "figure", "test.yaml", "curves", f"{folder}/curves.png", "batches")
        assert done.returncode == 0, done.stderr
    served, alone = ([(tmp_path / folder / name).read_bytes() for name in files] for folder in ("served", "alone"))
    assert served == alone


def test_what_is_wrong_is_told_as_without_a_server(holder, scene_file, tmp_path):
    wrong = ("batch", "test.yaml", "two-0", "data.nc", "cost.nc")
    with_server, without = (job(tmp_path, address, *wrong) for address in (holder[1], ""))
    assert (with_server.returncode, with_server.stderr) == (without.returncode, without.stderr)
    assert with_server.returncode == 1


def test_a_server_that_is_gone_is_done_without(holder, scene_file, tmp_path):
    holder[0].communicate(timeout=PATIENCE)
    assert not Path(holder[1]).exists()
    assert job(tmp_path, holder[1], *BATCH).returncode == 0


def test_a_server_ends_with_the_process_that_started_it(holder):
    process, address = holder
    process.kill()
    end = time.monotonic() + PATIENCE
    while Path(address).parent.exists():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_other_commands_run_by_themselves(monkeypatch):
    monkeypatch.setenv(server.ADDRESS, "/no/such/socket")
    assert server.delegate(["--version"]) is None
    assert server.delegate(["batch"]) is None


def test_a_server_of_another_copy_is_not_used(holder, monkeypatch):
    """It answers that it is not able to, and the command runs by itself."""
    monkeypatch.setenv(server.ADDRESS, holder[1])
    monkeypatch.setattr(server, "_identity", lambda: {"python": sys.prefix, "package": "/elsewhere"})
    assert server.delegate(["batch"]) is None


@pytest.fixture
def long_job(tmp_path):
    """Starts a job that takes longer than anybody waits, with the server that has this address."""
    (tmp_path / "test.yaml").write_text(SCENE.replace("demelio", "bem").replace("m: 2", "m: 8"))
    started = []

    def start(address):
        environment = os.environ | {"PYTHONPATH": os.getcwd(), "NUMBA_DISABLE_JIT": "1"} | server.ONE_THREAD
        environment |= {server.ADDRESS: address}
        command = [sys.executable, "-m", "weier", *BATCH]
        started.append(subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True))
        return started[0]

    yield start
    with started[0] as process:  # whose pipe a process that works for it may still hold
        process.kill()


@pytest.mark.parametrize("served", [True, False])
def test_ctrl_c_ends_a_job_in_one_sentence(served, holder, long_job):
    """As a terminal sends it: to the job and to the process that works for it."""
    process = long_job(holder[1] if served else "")
    (serving,) = _children(holder[0].pid)
    solving = _wait_for_one_that_solves(process, (lambda: _children(serving)) if served else (lambda: [process.pid]))
    start = time.monotonic()
    for number in {solving, process.pid}:
        os.kill(number, signal.SIGINT)
    _, said = process.communicate(timeout=PATIENCE)
    assert time.monotonic() - start < PATIENCE / 2
    assert process.returncode == 130
    assert said.splitlines()[-1].startswith("weier: stopped by Ctrl-C")
    assert "Traceback" not in said


def test_ctrl_c_ends_a_job_that_waits_for_the_server(holder, scene_file, tmp_path):
    """Nobody works for it yet, and the server has the signal."""
    assert job(tmp_path, holder[1], *BATCH).returncode == 0  # the server is well under way
    (serving,) = _children(holder[0].pid)
    os.kill(serving, signal.SIGINT)
    done = job(tmp_path, holder[1], *BATCH[:3], "another.nc", "cost.nc")
    assert (done.returncode, done.stderr) == (130, f"{server.STOPPED}\n")
    assert not (tmp_path / "another.nc").exists()


def test_ctrl_c_ends_a_job_and_a_server_that_had_not_answered(tmp_path):
    address = tmp_path / "socket"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(address))
        listener.listen()
        environment = os.environ | {server.ADDRESS: str(address), "PYTHONPATH": os.getcwd()}
        command = [sys.executable, "-m", "weier", *BATCH]
        with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
            connection, _ = listener.accept()
            with connection:
                assert connection.makefile("rb").readline()  # the whole request
                time.sleep(0.1)  # until it waits for the answer
                process.send_signal(signal.SIGINT)
                time.sleep(0.5)
                assert process.poll() is None  # it waits for what whoever works for it has to say
            _, said = process.communicate(timeout=PATIENCE)
    assert (process.returncode, said) == (130, f"{server.STOPPED}\n")


def test_a_job_that_is_killed_leaves_nobody_at_work(holder, long_job):
    process = long_job(holder[1])
    (serving,) = _children(holder[0].pid)
    solving = _wait_for_one_that_solves(process, lambda: _children(serving))
    process.kill()
    end = time.monotonic() + PATIENCE
    while _is_python(solving):
        assert time.monotonic() < end
        time.sleep(0.02)


def _children(process):
    return [int(word) for word in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def _wait_for_one_that_solves(process, candidates):
    """Nothing else has a second thread: a server also runs git for a moment, for the versions that files name."""
    found = []

    def solves():
        found[:] = [each for each in candidates() if _is_python(each) and _threads(each) > 1]
        return found

    _wait(process, solves)
    return found[0]


def _is_python(process):
    try:
        return b"weier" in Path(f"/proc/{process}/cmdline").read_bytes().split(b"\0")
    except OSError:  # it has ended
        return False


def _threads(process):
    try:
        return len(list(Path(f"/proc/{process}/task").iterdir()))
    except OSError:
        return 0


def _wait(process, until):
    end = time.monotonic() + PATIENCE
    while not until():
        assert time.monotonic() < end
        assert process.poll() is None
        time.sleep(0.02)


PREPARED = """
import gc
from weier import scene
from weier.pipeline import server
server._prepare(".", "batch", "--threads", "1", "test.yaml", "one-0")
frozen = gc.get_freeze_count()
print("batches" in vars(scene.load("test.yaml")), frozen > len(gc.get_objects()))
"""


DRAWN = """
import sys
from weier.pipeline import server
server._prepare(".", "figure", "test.yaml", "curves")
print(*sorted(name for name in sys.modules if name.startswith("matplotlib.backends.backend_")))
"""


def test_a_figure_finds_the_formats_of_its_files_loaded(scene_file):
    environment = os.environ | {"PYTHONPATH": os.getcwd()}
    command = [sys.executable, "-c", DRAWN]
    done = subprocess.run(command, cwd=scene_file.parent, env=environment, capture_output=True, text=True, check=True)
    assert {f"matplotlib.backends.backend_{name}" for name in ("agg", "pdf", "svg")} <= set(done.stdout.split())


# Such as an import that fails.
BROKEN = """
import socket, sys
from weier.cli import main
from weier.pipeline import server

def broken(*_):
    raise ZeroDivisionError

server._load = broken
server.serve(socket.socket(fileno=int(sys.argv[1])), main)
"""


def test_a_server_that_cannot_load_does_its_jobs_all_the_same(scene_file, tmp_path):
    (tmp_path / "server").mkdir()
    address = tmp_path / "server/socket"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(address))
        listener.listen()
        serving = subprocess.Popen(
            [sys.executable, "-c", BROKEN, str(listener.fileno())],
            stdin=subprocess.PIPE,
            pass_fds=[listener.fileno()],
            env=os.environ | {"PYTHONPATH": os.getcwd()},
        )
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as killed:
        killed.connect(str(address))  # by a job that ends before it asks
    for arguments, code in ((BATCH, 0), ((*BATCH[:2], "two-0", *BATCH[3:]), 1)):
        done = job(tmp_path, str(address), *arguments)
        assert done.returncode == code
        assert done.stderr
    serving.communicate(timeout=PATIENCE)
    assert serving.returncode == 0


def test_a_job_finds_the_batches_of_its_scene_made_and_out_of_the_collectors_way(scene_file):
    environment = os.environ | {"PYTHONPATH": os.getcwd()}
    command = [sys.executable, "-c", PREPARED]
    done = subprocess.run(command, cwd=scene_file.parent, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == "True True\n"
