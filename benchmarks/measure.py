"""Time the programs in turn, examine their solutions, and keep all in one dataset."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Mapping, Sequence
from time import process_time

import numpy as np
import xarray as xr

from benchmarks.problem import Examination, Problem, examine, find_reference
from benchmarks.programs import PROGRAMS, calibrate, seconds, solve_loads
from weier import Profile
from weier.kernels.arrays import Array

Say = Callable[[str], None]
Plan = Mapping[int, Sequence[str]]  # the programs to run, by their nodes

WRONG = 10.0  # residual over tolerance above which a solution reported as converged is wrong

# Dimensions of variables.
RUN = ("program", "points")
CURVE = (*RUN, "mean_pressure")
VARIABLES = {
    "seconds": (*RUN, "repeat"),  # processor time for the whole curve, set-up included
    "work": CURVE,  # FFT pairs or dense solutions
    "compliance": CURVE,  # in g_0
    "residual": CURVE,  # largest violation of a contact condition, freshly evaluated, in g_0
    "load_error": CURVE,  # relative error of the mean pressure
    "own_tolerance": CURVE,  # loosest tolerance of the solver that meets the target residual
    "converged": CURVE,  # 1 where the solver says that it converged
    "error": RUN,  # largest error of the compliance over the loads, in g_0
}


def blank(plan: Plan, loads: Array, repeats: int) -> xr.Dataset:
    """Return an empty dataset of all variables."""
    programs = list(dict.fromkeys(name for names in plan.values() for name in names))
    sizes = {"program": len(programs), "points": len(plan), "repeat": repeats, "mean_pressure": loads.size}
    data = xr.Dataset(
        {name: (dims, np.full([sizes[dim] for dim in dims], np.nan)) for name, dims in VARIABLES.items()}
    )
    labels, units = ([getattr(PROGRAMS[name], field) for name in programs] for field in ("label", "work"))
    coordinates = {"program": programs, "points": list(plan), "mean_pressure": loads}
    return data.assign_coords(**coordinates, label=("program", labels), work_unit=("program", units))


def compare(profile: Profile, loads: Array, plan: Plan, tolerance: float, repeats: int, say: Say) -> xr.Dataset:
    """Examine every program on every grid, and time the programs and the reference in turn.

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    loads : array, shape (loads,)
        Mean pressures, increasing, in p_0*.
    plan : mapping
        From the nodes in one period to the names of the programs to run.
    tolerance : float
        Residual that every program must reach, in g_0.
    repeats : int
        Timed runs of each program.
    say : function
        Called with a line about each step, for people.

    Returns
    -------
    Dataset
        Over program, points, repeat and mean_pressure; NaN where a program was not run. Attributes have the
        conditions of the measurement.

    """
    data, reference, reference_seconds = blank(plan, loads, repeats), find_reference(profile, loads), list[float]()
    for points, programs in plan.items():
        problem = Problem(profile, loads, points, tolerance)
        for name in programs:
            _examine_program(name, problem, reference, data)
            say(f"N = {points}: {PROGRAMS[name].label} examined")
        for repeat in range(repeats):
            for name in programs:
                at = {"program": name, "points": points}
                taken = seconds(PROGRAMS[name], problem, data["own_tolerance"].sel(at).values)
                data["seconds"].loc[{**at, "repeat": repeat}] = taken
                say(f"N = {points}: {PROGRAMS[name].label}, run {repeat + 1} of {repeats}: {taken:.4g} s")
            begin = process_time()
            find_reference(profile, loads)
            reference_seconds.append(process_time() - begin)
    packages = (PROGRAMS[name].version(PROGRAMS[name].package) for name in data["program"].values.tolist())
    return data.assign_attrs(
        D=profile.D,
        gamma=str(profile.gamma),
        m=profile.m,
        tolerance=tolerance,
        reference_seconds=min(reference_seconds),
        packages=", ".join(dict.fromkeys(packages)),
        machine=f"{platform.machine()}, {os.cpu_count()} processors, Python {platform.python_version()}",
    )


def _examine_program(name: str, problem: Problem, reference: Array, data: xr.Dataset) -> None:
    """Store everything except the time in the row of this program and size."""
    program = PROGRAMS[name]
    own_tolerance = calibrate(program, problem)
    solver = (program.counted or program.begin)(problem)
    height, eigenvalue = problem.height, program.eigenvalue(problem.points, problem.profile.period)
    rows = []
    steps = solve_loads(solver, problem.loads, own_tolerance)
    for load, step in zip(problem.loads[::-1], steps, strict=True):
        found = examine(problem, height, eigenvalue, load, step.pressure)
        if step.compliance is not None:
            found = found._replace(compliance=step.compliance)
        rows.append((step.work, step.converged, *found))
    at = {"program": name, "points": problem.points}
    names = ("work", "converged", *Examination._fields)
    for variable, values in zip(names, np.array(rows, float)[::-1].T, strict=True):
        data[variable].loc[at] = values
    data["own_tolerance"].loc[at] = own_tolerance
    data["error"].loc[at] = np.abs(data["compliance"].sel(at) - reference).max()


def wrong(data: xr.Dataset) -> xr.DataArray:
    """Count loads that each program reports as converged with a wrong residual or load."""
    tolerance = WRONG * data.attrs["tolerance"]
    far = (data["residual"] > tolerance) | (data["load_error"] > tolerance)
    reported: xr.DataArray = far & (data["converged"] == 1)
    return reported.sum("mean_pressure")


def failed(data: xr.Dataset) -> xr.DataArray:
    """Count loads that each program reports as not converged."""
    return (data["converged"] == 0).sum("mean_pressure")
