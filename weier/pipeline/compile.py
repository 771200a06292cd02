"""Kernels compiled in advance: those of all methods by `weier compile`, and those of a batch before it is solved."""

from __future__ import annotations

import fcntl
import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import numpy as np

from weier.kernels import jit
from weier.methods import registry
from weier.methods.errors import NotApplicableError
from weier.methods.fields import events, fields
from weier.methods.method import Method, Settings
from weier.methods.registry import find_method
from weier.pipeline.solve import solve
from weier.scene.case import Case
from weier.theory.profile import Profile

LOADS = np.geomspace(1e-3, 10, 12)  # few contacts and few gaps: the patches have a problem of their own for each
TWO_WAVES = Profile(D=1.25, gamma=2, m=2)
INFINITE = Profile(D=1.02, gamma=10, m=math.inf)  # whose first terms say all but all of it: small grids

LOADED: set[str] = set()  # names of tasks


class Task(NamedTuple):
    """The kernels that a method runs with some settings, on finite series or on infinite ones."""

    method: str
    settings: Settings
    infinite: bool

    @property
    def name(self) -> str:
        """A file name, which is another for other tasks."""
        text = json.dumps([self.settings, self.infinite], sort_keys=True)
        return f"{self.method}-{hashlib.sha256(text.encode()).hexdigest()[:8]}"

    def run(self) -> None:
        """Solve two waves or the infinite series, so that numba keeps the kernels in its cache."""
        profile, loads = (INFINITE, LOADS[:1]) if self.infinite else (TWO_WAVES, LOADS)
        with suppress(NotApplicableError):
            solve(profile, loads, self.method, **self.settings)


def compile_for(cases: Iterable[Case]) -> None:
    """Compile what these cases run, each task in one process while others take other tasks or wait for it.

    So no two jobs compile the same kernel side by side, and those that start together share the work.
    """
    waiting = [task for task in _tasks_of(cases) if not _done(task)]
    for wait in (False, True):
        for task in list(waiting):
            with _locked(task, wait) as free:
                if free:
                    waiting.remove(task)
                    _run_once(task)


def load_for(cases: Iterable[Case]) -> None:
    """Load what these cases run, as far as it is compiled: once for all processes that are forked from this one."""
    for task in _tasks_of(cases):
        if _done(task) and task.name not in LOADED:
            LOADED.add(task.name)
            task.run()


def compile_kernels() -> None:
    """Compile whatever has kernels."""
    if jit.disabled():
        return
    for method in registry.METHODS:
        for settings in (*method.algorithms, *method.options):
            for infinite in (False, True):
                Task(method.name, settings, infinite).run()
        method.run_rare_kernels()
    fields(TWO_WAVES, 0.1)
    events(TWO_WAVES, LOADS[0], LOADS[-1])


def _tasks_of(cases: Iterable[Case]) -> list[Task]:
    """What to compile for cases, each once; plans may run any method, and which is not known yet."""
    if jit.disabled():
        return []
    tasks: dict[str, Task] = {}
    for case in cases:
        for name in case.methods:
            method = find_method(name)
            if not method.runs_others:
                task = Task(name, _kind(method, case.settings.get(name, {})), math.isinf(case.profile.m))
                tasks[task.name] = task
    return list(tasks.values())


def _kind(method: Method, settings: Mapping[str, Any]) -> Settings:
    """Those of the settings that choose between kernels."""
    choices = (*method.algorithms, *method.options)
    fitting = [each for each in choices if all(settings.get(name) == value for name, value in each.items())]
    return max(fitting, key=len, default={})


def _done(task: Task) -> bool:
    with suppress(OSError):
        return (jit.folder() / "compiled" / task.name).exists()
    return False


def _run_once(task: Task) -> None:
    if not _done(task):
        task.run()
        with suppress(OSError):
            (jit.folder() / "compiled" / task.name).touch()


@contextmanager
def _locked(task: Task, wait: bool) -> Iterator[bool]:
    """Whether this process has the task for itself: until the block ends, or the process; True without a cache."""
    try:
        locks = jit.folder() / "compiled"
        locks.mkdir(parents=True, exist_ok=True)
        lock = (locks / f"{task.name}.lock").open("w")
    except OSError:  # closed to writing, or nowhere: each kernel is compiled when it is called
        yield True
        return
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            yield False
        else:
            yield True
