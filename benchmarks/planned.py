"""Expected errors and seconds of planned curves against the true ones: `python -m benchmarks.planned [COUNT]`.

COUNT random finite series are compared with contact patches, and a fifth as many infinite series with more terms of
themselves, at loads from 1e-12 p_0*.
"""

from __future__ import annotations

import click
import numpy as np

from benchmarks.verification import Verified, verify, verify_infinite


@click.command()
@click.argument("count", type=click.IntRange(1), default=200)
def main(count: int) -> None:
    """Print which of COUNT series, by default 200, miss what they expect, and how much too wide the others are."""
    for what, found in (("finite", list(verify(count))), ("infinite", list(verify_infinite(count // 5)))):
        for curve in found:
            if not curve.inside or not curve.kept:
                print("missed:", curve)
        inside = sum(curve.inside for curve in found)
        print(f"{what}: {inside} of {len(found)} curves are within the errors they expect,")
        print(f"{sum(curve.kept for curve in found)} within the tolerance they were planned for")
        for methods in sorted({curve.methods for curve in found}):
            for quantity in ("compliance", "resistance"):
                report(methods, quantity, [e for e in found if e.methods == methods and e.quantity == quantity])
            report_seconds(", ".join(methods), [e for e in found if e.methods == methods])
        report_seconds("all", found)


def report(methods: tuple[str, ...], quantity: str, found: list[Verified]) -> None:
    """Print by which factors the expected errors of curves by the same methods exceed the true ones."""
    checks = [getattr(curve, quantity) for curve in found]
    width = [check.expected / check.true for check in checks if check.true > 1e-14 and check.expected > 0]
    if width:
        low, middle, high = np.quantile(width, [0, 0.5, 0.9])
        names = ", ".join(methods)
        print(f"{quantity} by {names}: {len(found)} curves, too wide by {low:.2g} to {high:.2g}, median {middle:.2g}")


def report_seconds(names: str, found: list[Verified]) -> None:
    """Print by which factors curves by some methods took longer than planned."""
    ratio = np.array([curve.seconds / curve.planned_seconds for curve in found])
    within = (np.mean((ratio > 1 / factor) & (ratio < factor)) for factor in (3, 10))
    print(f"seconds of {ratio.size} curves by {names}: {{:.0%}} within a factor of 3, {{:.0%}} of 10".format(*within))
    low, middle, high = np.quantile(ratio, [0.05, 0.5, 0.95])
    print(
        f"took over planned: median {middle:.2g}, 5 % below {low:.2g}, 5 % above {high:.2g}, most {ratio.max():.2g}"
    )


if __name__ == "__main__":
    main()
