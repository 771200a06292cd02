"""The measurements of weier itself: `python -m weier.accuracy NAME`."""

from weier.accuracy.measurement import commands

NAMES = ("convergence", "coverage", "extremes", "tradeoff")
main = commands("weier.accuracy", NAMES, "Measure weier itself: errors, seconds, and coverage of stated errors.")

if __name__ == "__main__":
    main()
