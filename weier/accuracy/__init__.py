"""Speed and accuracy measured: the trade between them, stability at the extremes, convergence of the infinite series.

May use the pipeline and all below it.
"""
