# Reference values for history.rs, by metafor 3.8-1 (W. Viechtbauer, J. Stat. Softw. 36, 2010) and R 4.2.2:
#   Rscript generate.R
# Each series has sessions with times, values and variances of their own. Numbers are printed with 12 digits.
library(metafor)
set.seed(20261123)

between <- c(0, 1, 4, 25, 0.04, 9)
sizes <- c(3, 5, 8, 12, 60, 4)
control <- list(threshold = 1e-14, maxiter = 1000, tol = 1e-14)
points <- NULL
results <- NULL
for (s in seq_along(sizes)) {
  k <- sizes[s]
  t <- sort(round(runif(k, 0, 6), 3))
  v <- round(exp(rnorm(k, 0, 0.7)), 4)
  y <- round(100 + 0.8 * t + rnorm(k, 0, sqrt(v + between[s])), 4)
  points <- rbind(points, data.frame(series = s, time = t, value = y, variance = v))
  for (curve in c("constant", "line")) {
    mods <- if (curve == "line") ~t else ~1
    fit <- rma(y, v, mods = mods, method = "PM", test = "knha", control = control)
    # The statistic of heterogeneity and the interval by Q profiles.
    profile <- confint(fit, control = list(tol = 1e-13, maxiter = 10000, tau2.max = 1e5))$random["tau^2", ]
    at <- max(t) + 1
    here <- if (curve == "line") predict(fit, newmods = at) else predict(fit)
    slope <- if (curve == "line") c(fit$beta[2], fit$se[2], fit$ci.lb[2], fit$ci.ub[2]) else rep(NA, 4)
    results <- rbind(results, data.frame(
      series = s, curve = curve, q = fit$QE, p = fit$QEp, tau2 = fit$tau2,
      low = profile[["ci.lb"]], high = profile[["ci.ub"]],
      at = at, level = here$pred, se = here$se, level_low = here$ci.lb, level_high = here$ci.ub,
      slope = slope[1], slope_se = slope[2], slope_low = slope[3], slope_high = slope[4]))
  }
}
options(digits = 12)
write.csv(points, "points.csv", row.names = FALSE, quote = FALSE)
write.csv(format(results, digits = 12, scientific = TRUE), "metafor.csv", row.names = FALSE, quote = FALSE)
# Welch's test of equal means, of the values of series 3, 4 and 5 as batches.
batches <- points[points$series %in% 3:5, ]
welch <- oneway.test(value ~ series, batches)
cat(sprintf("F %.12g df %.12g %.12g p %.12g\n", welch$statistic, welch$parameter[1], welch$parameter[2], welch$p.value), file = "welch.txt")
