"""What the workflow does: cases are solved in batches, gathered into files, and held against the claims of the paper.

May use scenes, methods, data and theory; when each step runs stands in the Snakefile.
"""
