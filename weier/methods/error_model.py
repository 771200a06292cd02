"""The error by a residual, and rounding: common to several methods."""

# A solution is exact for a surface that differs from the given one by its residual at most. By the bounds theorem, so
# does its compliance. The factor of 2 allows for larger residuals between the points at which it is known.
RESIDUAL_FACTOR = 2.0
COMPLIANCE_ROUNDING = 1e-14  # Rounding of a compliance, over the total amplitude.
