"""Expected errors of planned curves against their true errors: `python -m benchmarks.planned [COUNT]`.

COUNT random finite series are compared with contact patches, and a fifth as many infinite series with more terms of
themselves, at loads from 1e-12 p_0*.
"""

from __future__ import annotations

import sys

import numpy as np

from tests.verification import Verified, verify, verify_infinite


def main() -> None:
    """Print each curve that misses what it expects, and how much too wide the others are."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for what, found in (("finite", list(verify(count))), ("infinite", list(verify_infinite(count // 5)))):
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
    """Print by which factors the expected errors of curves by the same methods exceed the true ones."""
    checks = [getattr(each, quantity) for each in found]
    width = [check.expected / check.true for check in checks if check.true > 1e-14 and check.expected > 0]
    if width:
        low, middle, high = np.quantile(width, [0, 0.5, 0.9])
        names = ", ".join(methods)
        print(f"{quantity} by {names}: {len(found)} curves, too wide by {low:.2g} to {high:.2g}, median {middle:.2g}")


if __name__ == "__main__":
    main()
