"""Steps of the workflow: solve cases in batches, gather them into files, judge the claims of the paper.

May use scene, methods, data, theory and kernels; the Snakefile says when each step runs.
"""
