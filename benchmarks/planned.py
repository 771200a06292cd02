"""How far the errors that planned curves expect are from those they have: `python -m benchmarks.planned [COUNT]`.

COUNT random finite series against contact patches, a fifth as many endless ones against more terms, at loads from
1e-12 p_0*.
"""

from __future__ import annotations

import sys

import numpy as np

from tests.verification import Verified, verify, verify_infinite


def main() -> None:
    """Print each curve that misses what it expects, and how much too wide the others are."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for what, found in (("finite", list(verify(count))), ("endless", list(verify_infinite(count // 5)))):
        for each in found:
            if not each.inside or not each.kept:
                print("missed:", each)
        print(
            f"{what}: {sum(each.inside for each in found)} of {len(found)} curves are within the errors they expect,"
        )
        print(f"{sum(each.kept for each in found)} within the tolerance they were planned for")
        for methods in sorted({each.methods for each in found}):
            for quantity in ("compliance", "resistance"):
                report(methods, quantity, [e for e in found if e.methods == methods and e.quantity == quantity])


def report(methods: tuple[str, ...], quantity: str, found: list[Verified]) -> None:
    """How much too wide the expected errors of curves by the same methods are."""
    checks = [getattr(each, quantity) for each in found]
    width = [check.expected / check.true for check in checks if check.true > 1e-14 and check.expected > 0]
    if width:
        low, middle, high = np.quantile(width, [0, 0.5, 0.9])
        names = ", ".join(methods)
        print(f"{quantity} by {names}: {len(found)} curves, too wide by {low:.2g} to {high:.2g}, median {middle:.2g}")


if __name__ == "__main__":
    main()
