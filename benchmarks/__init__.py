"""Measurements, one command each; `python -m benchmarks` sets weier beside other programs.

to_error : processor time to a given error, beside other programs
trade : seconds and errors of each method on random series
stated_errors : whether methods keep the errors that they state, on families of hard series
parts : what estimates, batches, the import and compiling cost
float32 : what single precision would gain
"""
