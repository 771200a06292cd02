"""Measured heights: reading files of text, units, artefacts, and the trace that they make."""
