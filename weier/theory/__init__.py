"""The surface and what is known of its contact in closed form: series, phases, half-plane, bounds, conduction.

Imports nothing else of weier but kernels.
"""
