"""What the workflow does: cases are solved in batches, gathered into files, and held against the claims of the paper.

May use scene, methods, data, theory and kernels; the Snakefile says when each step runs.
"""
