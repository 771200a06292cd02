"""The jobs of a run from one process that has imported the program: importing takes longer than most of the jobs.

The Snakefile starts `weier serve`, which listens on a socket that WEIER_SERVER names. A job that finds it there hands
over its arguments, environment, folder and standard files, and the server forks a process that does the work in its
place. Where there is no server, or one of another Python, the job does its work itself.
"""

from __future__ import annotations

import fcntl
import gc
import itertools
import json
import os
import signal
import socket
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from select import select
from typing import Any

ADDRESS = "WEIER_SERVER"
# What to import before a process is forked for a command; the other commands are run by the job itself.
IMPORTS: Mapping[str, tuple[str, ...]] = {
    "batch": (
        "weier.cli.scene", "weier.pipeline.claims", "weier.pipeline.batch", "weier.pipeline.compile", "jsonschema",
    ),
    "claims": (
        "weier.cli.scene", "weier.pipeline.claims", "weier.pipeline.gather", "weier.pipeline.labels", "jsonschema",
    ),
    "figure": ("weier.cli.scene", "weier.pipeline.claims", "weier.pipeline.gather", "jsonschema"),
}  # fmt: skip
COMPILER = "weier.kernels.compiler"  # numba, for what solves
SOLVING = ("batch",)
DRAWING = ("figure",)
UNABLE = b"?"  # the answer of a server that is no match for a job
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}  # of BLAS, which are started on import
INTERRUPTED = 130  # exit code after Ctrl-C, as of shells
STOPPED = "weier: stopped by Ctrl-C; files that were being written are as they were"
QUEUE = 128  # jobs that may wait
PATIENCE = 0.5  # seconds between looks at what has ended


class _Interruption:
    """Whether this process has seen Ctrl-C, for jobs that had none to work for them yet.

    It has no lock, as a threading.Event has, for which a second signal would wait inside the first.
    """

    seen = False

    def note(self, *_: object) -> None:
        """Handle the signal."""
        self.seen = True


INTERRUPTION = _Interruption()


def say_interrupted() -> None:
    """Tell that Ctrl-C has ended a command."""
    print(STOPPED, file=sys.stderr)


def delegate(arguments: Sequence[str]) -> int | None:
    """The exit code of a command that a server has run, or None where none did."""
    address = os.environ.get(ADDRESS)
    if not address or not arguments or arguments[0] not in IMPORTS:
        return None
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        try:
            connection.connect(address)
            socket.send_fds(connection, [b"!"], [0, 1, 2])
            request = {"arguments": arguments, "folder": os.getcwd(), "environment": dict(os.environ), **_identity()}
            connection.sendall(json.dumps(request).encode() + b"\n")
        except OSError:
            return None
        answer = _wait(connection)
    return None if answer == UNABLE else int(answer or b"1")  # without a word if it was killed


def _wait(connection: socket.socket) -> bytes:
    interrupted = False
    while True:
        try:
            answer = connection.recv(16)
        except KeyboardInterrupt:  # the other process has it, too, and says so
            interrupted = True
            continue
        except ConnectionResetError:  # by a server that was killed before it read the request
            answer = b""
        if interrupted and not answer:  # the server ended by it, before anybody was at work
            raise KeyboardInterrupt
        return answer


def _identity() -> dict[str, str]:
    """Which Python and which copy of the package: a job's own, or it has to run by itself."""
    return {"python": sys.prefix, "package": str(Path(__file__).parents[1])}


def start() -> Callable[[], None]:
    """Start a server for all jobs of this process; what is returned ends it, when its jobs have ended.

    It also ends with this process, however that does: its standard input is a pipe from here.
    """
    import subprocess  # jobs need neither of these
    import tempfile

    folder = Path(tempfile.mkdtemp(prefix="weier-"))
    address = folder / "socket"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        try:
            listener.bind(str(address))
        except OSError:  # such as a name that is too long for a socket
            folder.rmdir()
            return lambda: None
        listener.listen(QUEUE)  # from now on jobs wait for the server rather than do without
        server = subprocess.Popen(
            [sys.executable, "-m", "weier", "serve", str(listener.fileno())],
            stdin=subprocess.PIPE,
            env=os.environ | ONE_THREAD,
            pass_fds=[listener.fileno()],
        )
    os.environ[ADDRESS] = str(address)

    def stop() -> None:
        os.environ.pop(ADDRESS, None)
        server.communicate()  # closes its standard input, and waits

    return stop


def serve(listener: socket.socket, main: Callable[[], None]) -> None:
    """Fork a process for each job until standard input ends, with whoever started the server.

    Parameters
    ----------
    listener : socket
        Where jobs ask.
    main : callable
        The command line: it reads sys.argv and ends by SystemExit.
    """
    signal.signal(signal.SIGINT, INTERRUPTION.note)  # the jobs end by it, and this when all have
    address = Path(listener.getsockname())
    with listener:
        started = True
        while started:
            ready, _, _ = select([listener, sys.stdin], [], [], PATIENCE)
            if listener in ready:
                _fork(listener, main)
            started = sys.stdin not in ready
            _reap(os.WNOHANG)
    address.unlink(missing_ok=True)
    address.parent.rmdir()
    _reap(0)


def _reap(options: int) -> None:
    """Ask how processes ended, so that what they took counts as taken by this one."""
    with suppress(ChildProcessError):
        while os.waitpid(-1, options)[0]:
            pass


def _fork(listener: socket.socket, main: Callable[[], None]) -> None:
    connection, _ = listener.accept()
    with connection, suppress(OSError, ValueError):  # of a job that was killed before it had asked
        _, descriptors, _, _ = socket.recv_fds(connection, 1, 3)
        try:
            request = json.loads(connection.makefile("rb").readline())
            if {name: request[name] for name in _identity()} != _identity():
                connection.sendall(UNABLE)
            else:
                if not INTERRUPTION.seen:
                    _prepare(request["folder"], *request["arguments"])
                if os.fork() == 0:
                    listener.close()
                    _run(connection, descriptors, request, main)
        finally:
            for descriptor in descriptors:
                os.close(descriptor)


def _prepare(folder: str, command: str, *arguments: str) -> None:
    """Load what a command needs, for the process that is forked: as far as that goes, since other jobs wait."""
    with suppress(Exception):  # whatever it is, the process meets it, too, and tells
        _load(folder, command, *arguments)
    gc.freeze()  # or the collector of a job would write to, and so copy, all that it shares with this process


def _load(folder: str, command: str, *arguments: str) -> None:
    """Import what a command needs, and load the kernels of its batch.

    Loading the kernels takes longer than solving some dozens of cases.
    """
    for name in IMPORTS[command]:
        import_module(name)
    if command in SOLVING and not (jit := import_module("weier.kernels.jit")).disabled():
        import_module(COMPILER)
        jit.folder()  # reads all sources, once for all jobs
    if command in DRAWING:
        import_module("weier.figures").prepare()  # which imports matplotlib, too
    os.chdir(folder)
    path, *names = itertools.dropwhile(lambda argument: not argument.endswith(".yaml"), arguments)
    loaded = import_module("weier.scene").load(path)  # and kept, for the other jobs of its run
    if command in SOLVING:
        import_module("weier.pipeline.compile").load_for(loaded.batch(names[0]))
        import_module("weier.data.provenance").versions()  # which ask git


def _end_with(connection: socket.socket) -> None:
    """Let the system end this process when the other end is closed: a job that is killed leaves nobody at work."""
    signal.signal(signal.SIGIO, signal.SIG_DFL)  # which ends a process
    fcntl.fcntl(connection, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(connection, fcntl.F_SETFL, fcntl.fcntl(connection, fcntl.F_GETFL) | os.O_ASYNC)
    if select([connection], [], [], 0)[0]:  # it was closed before
        os.kill(os.getpid(), signal.SIGIO)


def _run(
    connection: socket.socket, descriptors: Sequence[int], request: Mapping[str, Any], main: Callable[[], None]
) -> None:
    """Do the work of a job, in the process that was forked for it, and end this."""
    code: object = 1
    try:
        for number, descriptor in enumerate(descriptors):
            os.dup2(descriptor, number)
        os.environ.clear()
        os.environ.update(request["environment"])
        os.chdir(request["folder"])
        sys.argv = ["weier", *request["arguments"]]
        signal.signal(signal.SIGINT, signal.default_int_handler)
        _end_with(connection)
        if INTERRUPTION.seen:
            raise KeyboardInterrupt
        main()
        code = 0
    except KeyboardInterrupt:
        say_interrupted()
        code = INTERRUPTED
    except SystemExit as stopped:
        code = stopped.code or 0
    finally:
        with suppress(OSError):
            sys.stdout.flush()
            sys.stderr.flush()
        with suppress(OSError):  # of a job that was killed: nothing may lead from here back into the server
            connection.sendall(str(code if isinstance(code, int) else 1).encode())
        os._exit(0)
