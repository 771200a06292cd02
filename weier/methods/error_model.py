"""Error due to a residual, and rounding, common to several methods."""

# A solution is exact for a surface that differs from the given one by at most the residual. By the bounds theorem its
# compliance differs by no more. The factor of 2 allows for larger residuals between the sampled points.
RESIDUAL_FACTOR = 2.0
COMPLIANCE_ROUNDING = 1e-14  # rounding error of a compliance over the total amplitude
