"""How far the errors that planned curves expect are from those they have: `python -m benchmarks.planned [COUNT]`."""

from __future__ import annotations

import sys

import numpy as np

from weier.tradeoff.verify import Verified, verify


def main() -> None:
    """Print each curve that misses what it expects, and how much too wide the others are."""
    found = list(verify(int(sys.argv[1]) if len(sys.argv) > 1 else 200))
    for each in found:
        if not each.inside or each.true > each.tolerance:
            print("missed:", each)
    print(f"{sum(each.inside for each in found)} of {len(found)} curves are within the error they expect,")
    print(f"{sum(each.true <= each.tolerance for each in found)} within the tolerance they were planned for")
    for method in dict.fromkeys(each.methods[0] for each in found):
        for quantity in ("compliance", "resistance"):
            report(method, quantity, [e for e in found if e.methods[0] == method and e.quantity == quantity])


def report(method: str, quantity: str, found: list[Verified]) -> None:
    """How much too wide the expected errors of a method are."""
    width = [each.expected / each.true for each in found if each.true > 1e-13 and each.expected > 0]
    if width:
        low, middle, high = np.quantile(width, [0, 0.5, 0.9])
        print(f"{method}, {quantity}: {len(found)} curves, too wide by {low:.2g} to {high:.2g}, median {middle:.2g}")


if __name__ == "__main__":
    main()
