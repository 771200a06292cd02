"""The description of a curve to solve, shared by `weier.solve`, lists, batches and the search for a load."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, NamedTuple

from weier.api.progress import clock
from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.errors import ConvergenceError, NotApplicableError
from weier.methods.registry import find_method
from weier.surface.profile import PARAMETERS, Profile
from weier.surface.waves import Waves

# The solution of a method and the seconds that it took, or the error.
Outcome = tuple[Curve, float] | NotApplicableError | ConvergenceError


class CurveTask(NamedTuple):
    """A curve to solve: surface, name of the method, its checked settings, and increasing loads in p_0*."""

    profile: Waves
    method: str
    settings: Mapping[str, Any]
    loads: Array

    @property
    def series(self) -> object:
        """The key of a curve without phases, which an ensemble shares; None for other curves."""
        if find_method(self.method).uses_phases or not isinstance(self.profile, Profile):
            return None
        parameters = (getattr(self.profile, name) for name in PARAMETERS)
        return self.method, *parameters, json.dumps(self.settings, sort_keys=True), self.loads.tobytes()

    @property
    def expected(self) -> float:
        """The expected seconds on one core; 0 if the method refuses the curve."""
        method = find_method(self.method)
        return float(method.seconds(self.profile, self.loads, **self.settings)) if method.takes(self.profile) else 0.0

    def solve(self) -> tuple[Curve, float]:
        """Return the solution and its seconds without compiling, or raise the error of the method."""
        method = find_method(self.method)
        method.check_applies(self.profile)
        start = clock()
        return method.solve(self.profile, self.loads, **self.settings), clock() - start

    def outcome(self) -> Outcome:
        """Return the solution and its seconds, or the error of the method."""
        try:
            return self.solve()
        except (NotApplicableError, ConvergenceError) as error:
            return error.with_traceback(None)  # the traceback would keep the solver's arrays alive
