"""Side by side, `python -m benchmarks`: weier, the paper's dense inversion, tamaas, ContactMechanics and slippy."""
