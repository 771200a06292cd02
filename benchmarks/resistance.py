"""Two schemes for the resistance with edges of contact on nodes: python -m benchmarks.resistance."""

from __future__ import annotations

import numpy as np

from tests.reference import REFERENCES, Reference
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.methods.bem import curve

MIN_LOAD = 1e-3  # a lighter load touches a single node of the default grid
STEPS = (0.01, 0.03, 0.1, 0.2)


def by_differences(reference: Reference, step: float) -> Array:
    """Centred differences of the compliance along ln p, one pair of loads at a time."""
    pairs = [load * np.exp([-step, step]) for load in reference.mean_pressure]
    return np.array(
        [np.diff(curve(reference.profile, p, edges="nodes").compliance)[0] / np.diff(p)[0] for p in pairs]
    )


def by_active_set(reference: Reference) -> Array:
    """The slope of the discrete curve on the contact as it stands."""
    return np.asarray(curve(reference.profile, reference.mean_pressure, edges="nodes").resistance)


def main() -> None:
    """Print median, ninth decile and maximum of the relative errors as a Markdown table."""
    references = [reference.above(MIN_LOAD) for reference in REFERENCES]
    schemes = {"active set": by_active_set}
    schemes |= {f"differences, delta = {s}": (lambda r, s=s: by_differences(r, s)) for s in STEPS}
    rows = []
    for name, scheme in schemes.items():
        errors = np.concatenate([relative_errors(reference, scheme(reference)) for reference in references])
        rows.append([name, f"{np.median(errors):.2%}", f"{np.quantile(errors, 0.9):.1%}", f"{errors.max():.0%}"])
    print(markdown.table(["scheme", "median", "90 %", "largest"], rows))


def relative_errors(reference: Reference, resistance: Array) -> Array:
    """|R/reference - 1| in partial contact; in full contact R = 0."""
    partial = reference.resistance > 0
    return np.abs(resistance[partial] / reference.resistance[partial] - 1)


if __name__ == "__main__":
    main()
