"""What contact patches offer to a plan: the loosest tolerance that keeps within that of the plan."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import COMPLIANCE_ROUNDING, RESIDUAL_FACTOR
from weier.methods.patches import error_model
from weier.methods.patches.solver import curve
from weier.methods.segment import RESISTANCE, Segment, SegmentSolution, Task, make_segment
from weier.theory.profile import Profile


def candidates(task: Task) -> Iterator[Segment]:
    """Contact patches where a computer holds them all; none for one wave, which has a closed form."""
    able = [each for each in error_model.TOLERANCES if error_model.error(each, task.quantity) <= task.tolerance]
    if task.profile.m > 1 and able:
        yield _patches(task, able[0])


def _patches(task: Task, tolerance: float) -> Segment:
    waves = task.profile.waves_per_period[-1]
    held = task.contacts <= error_model.MAX_CONTACTS
    error = np.where(held, error_model.error(tolerance, task.quantity), np.inf)
    return make_segment(
        task,
        "patches",
        "exact edges of these contacts cost less than a grid so fine",
        partial(_solve, task.profile, tolerance),
        settings={"tolerance": tolerance},
        discretisation=error,
        seconds_start=error_model.SECONDS_START,
        seconds_load=error_model.seconds(waves, task.contacts),
        memory=error_model.memory(waves, float(task.contacts.max(where=held, initial=1.0))),
    )


def _solve(profile: Profile, tolerance: float, loads: Array) -> SegmentSolution:
    exact = curve(profile, loads, tolerance)
    compliance_error = RESIDUAL_FACTOR * exact.residual + COMPLIANCE_ROUNDING * profile.total_amplitude
    resistance_error = error_model.error(tolerance, RESISTANCE) * np.maximum(exact.resistance, 1)
    partial_contact = exact.patch_count > 0
    return SegmentSolution(
        exact.compliance,
        exact.resistance,
        np.where(partial_contact, compliance_error, 0),
        np.where(partial_contact, resistance_error, 0),
    )
