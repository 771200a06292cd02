"""Speed and accuracy measured: the trade between them, stability at the extremes, convergence of the infinite series.

The trade and the extremes both run variants of methods on cases and compare what they give with a reference: `runner`
runs one of them, `reference` says what is right, `metrics` how far a curve is off, `comparison` fills a dataset, and
`report` writes tables. May use the pipeline and all below it.
"""
