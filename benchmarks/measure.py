"""Time the programs in turn, examine their solutions, and keep all in one self-describing dataset."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Mapping, Sequence
from time import process_time

import numpy as np
import xarray as xr

from benchmarks.problem import Examination, Problem, Reference, examine
from benchmarks.programs import PROGRAMS, calibrate, seconds, solve_loads
from weier import Profile, solve
from weier.kernels.arrays import Array

Say = Callable[[str], None]
Plan = Mapping[int, Sequence[str]]  # the programs to run, by their nodes

WRONG = 10.0  # residual over tolerance above which a solution reported as converged is wrong

# Dimensions of variables.
RUN = ("program", "points")
CURVE = (*RUN, "mean_pressure")
VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "seconds": ((*RUN, "repeat"), "processor time for the whole curve, set-up included", "s"),
    "work": (CURVE, "FFT pairs or dense solutions for this load", "1"),
    "compliance": (CURVE, "compliance, in g_0", "1"),
    "residual": (CURVE, "largest violation of a contact condition, freshly evaluated, in g_0", "1"),
    "load_error": (CURVE, "relative error of the mean pressure", "1"),
    "own_tolerance": (CURVE, "loosest tolerance of the solver that meets the target residual", "1"),
    "converged": (CURVE, "1 where the solver says that it converged", "1"),
    "error": (RUN, "largest error of the compliance over the loads, in g_0", "1"),
}


def blank(plan: Plan, loads: Array, repeats: int) -> xr.Dataset:
    """Return an empty dataset of all variables."""
    programs = list(dict.fromkeys(name for names in plan.values() for name in names))
    sizes = {"program": len(programs), "points": len(plan), "repeat": repeats, "mean_pressure": loads.size}
    data = xr.Dataset(
        {
            name: (dims, np.full([sizes[dim] for dim in dims], np.nan), {"long_name": long_name, "units": units})
            for name, (dims, long_name, units) in VARIABLES.items()
        }
    )
    pressure_attributes = {"long_name": "mean pressure", "units": "1", "normalised_by": "p_0*"}
    labels, units = ([getattr(PROGRAMS[name], field) for name in programs] for field in ("label", "work"))
    return data.assign_coords(
        program=("program", programs, {"long_name": "program that solved the problem"}),
        points=("points", list(plan), {"long_name": "nodes in one period", "units": "1"}),
        mean_pressure=("mean_pressure", loads, pressure_attributes),
        label=("program", labels, {"long_name": "program, for people"}),
        work_unit=("program", units, {"long_name": "what work counts"}),
    )


def describe(
    data: xr.Dataset, profile: Profile, tolerance: float, reference: Reference, reference_seconds: Sequence[float]
) -> xr.Dataset:
    """Add the reference as a variable, and the conditions of the measurement as attributes."""
    programs = [PROGRAMS[str(name)] for name in data["program"].values]
    attributes = {"long_name": f"compliance by method {reference.method}, in g_0", "units": "1"}
    return data.assign(reference_compliance=("mean_pressure", reference.compliance, attributes)).assign_attrs(
        D=profile.D,
        gamma=str(profile.gamma),
        m=profile.m,
        phase=profile.phase,
        tolerance=tolerance,
        reference_method=reference.method,
        reference_seconds=min(reference_seconds),
        threads=1,
        packages=", ".join(dict.fromkeys(program.version(program.package) for program in programs)),
        machine=f"{platform.machine()}, {os.cpu_count()} processors, Python {platform.python_version()}",
        discretisation=(
            "weier, slippy and the dense inversion take piecewise-linear pressure, tamaas and ContactMechanics "
            "trigonometric pressure (the Fourier kernel 1/|k|): each residual is that of its own discretisation."
        ),
    )


def compare(
    profile: Profile, loads: Array, plan: Plan, tolerance: float, repeats: int, reference: Reference, say: Say
) -> xr.Dataset:
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
    reference : Reference
        The reference compliance.
    say : function
        Called with a line about each step, for people.

    Returns
    -------
    Dataset
        Over program, points, repeat and mean_pressure; NaN where a program was not run.

    """
    data, reference_seconds = blank(plan, loads, repeats), list[float]()
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
            solve(profile, loads, **reference.settings)
            reference_seconds.append(process_time() - begin)
    return describe(data, profile, tolerance, reference, reference_seconds)


def _examine_program(name: str, problem: Problem, reference: Reference, data: xr.Dataset) -> None:
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
    data["error"].loc[at] = np.abs(data["compliance"].sel(at) - reference.compliance).max()


def wrong(data: xr.Dataset) -> xr.DataArray:
    """Count loads that each program reports as converged with a wrong residual or load."""
    tolerance = WRONG * data.attrs["tolerance"]
    far = (data["residual"] > tolerance) | (data["load_error"] > tolerance)
    reported: xr.DataArray = far & (data["converged"] == 1)
    return reported.sum("mean_pressure")


def failed(data: xr.Dataset) -> xr.DataArray:
    """Count loads that each program reports as not converged."""
    return (data["converged"] == 0).sum("mean_pressure")
