"""Runs of snakemake as forks of one process, which imports it once: each would spend most of a second on it."""

import atexit
import json
import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from threading import Lock

SERVER = """
import json, os, signal, sys
from snakemake import cli

for line in sys.stdin:
    arguments, folder, environment, files, limit = json.loads(line)
    if not (child := os.fork()):
        signal.alarm(limit)  # which ends a run that hangs, with the exit code -SIGALRM
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        for descriptor, file in enumerate(files):
            os.dup2(os.open(file, os.O_RDWR), descriptor)
        sys.argv[:] = ["snakemake", *arguments]
        cli.main(arguments)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
LIMIT = 900  # seconds of a run: the longest takes a minute on idle cores
LOCK = Lock()  # A server has one run at a time.


@cache
def _server():
    # -P: the folder of the server is no place for imports, as for the command of this name.
    command = [sys.executable, "-P", "-c", SERVER]
    server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    atexit.register(server.communicate)
    return server


def snakemake(*arguments, cwd=".", env=None):
    """The exit code, standard output and standard error of `snakemake`, as of `subprocess.run`."""
    arguments = list(map(str, arguments))
    with tempfile.TemporaryDirectory() as folder, LOCK:
        said = [Path(folder, name) for name in ("out", "err")]
        for path in said:
            path.touch()
        order = arguments, str(Path(cwd).resolve()), dict(env or os.environ), [os.devnull, *map(str, said)], LIMIT
        print(json.dumps(order), file=_server().stdin, flush=True)
        code = int(_server().stdout.readline())
        return subprocess.CompletedProcess(["snakemake", *arguments], code, *(path.read_text() for path in said))
