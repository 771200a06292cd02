"""Measured heights: reading files of text and of instruments, units, artefacts, and the trace that they make."""
