"""`python -m weier`."""

from weier.cli import main

if __name__ == "__main__":
    main()
