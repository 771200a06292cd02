"""Side by side: weier, the paper's dense inversion, tamaas and ContactMechanics on one profile; `python -m benchmarks`."""
