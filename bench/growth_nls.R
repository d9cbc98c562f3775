# SPDX-License-Identifier: GPL-3.0-or-later
# R's nls on the series that growth_bench times: three equations a tree, then MASS::confint's profile limits.
# usage: Rscript growth_nls.R TABLE.csv     (columns series,time,value; apt-get install r-base-core r-cran-mass)
table <- read.csv(commandArgs(trailingOnly = TRUE)[1])
trees <- split(table, table$series)
# Starts from the linearised equations, as a careful user would give them.
linear <- function(x, y) { ok <- is.finite(x) & is.finite(y); coef(lm(y[ok] ~ x[ok])) }
fits <- list(
  logistic = function(d) {
    top <- 1.05 * max(d$value); l <- linear(d$time, log(top / d$value - 1))
    nls(value ~ Xm / (1 + (Xm / X0 - 1) * exp(-r * time)), d,
        start = list(X0 = top / (1 + exp(l[[1]])), Xm = top, r = -l[[2]]))
  },
  bertalanffy = function(d) {
    top <- 1.05 * max(d$value); l <- linear(d$time, -log(1 - (d$value / top)^(1 / 3)))
    nls(value ~ b1 * (1 - exp(-b2 * time))^3, d, start = list(b1 = top, b2 = l[[2]]))
  },
  weibull = function(d) {
    top <- 1.05 * max(d$value); l <- linear(log(d$time), log(-log(1 - d$value / top)))
    nls(value ~ w1 * (1 - exp(-w2 * time^w3)), d, start = list(w1 = top, w2 = exp(l[[1]]), w3 = l[[2]]))
  }
)
cpu <- function(expression) { t <- system.time(expression); t[["user.self"]] + t[["sys.self"]] }
models <- list()
fitting <- cpu(for (d in trees) for (fit in fits)
  models[[length(models) + 1]] <- tryCatch(fit(d), error = function(e) NULL))
good <- Filter(Negate(is.null), models)
unprofiled <- 0
profiling <- cpu(for (m in good)
  if (is.null(tryCatch(suppressMessages(MASS:::confint.nls(m)), error = function(e) NULL))) unprofiled <- unprofiled + 1)
cat(sprintf("R %s nls: %d fits %.3f CPU s (%d failed); profile limits %.3f CPU s more (%d failed)\n",
            getRversion(), length(models), fitting, length(models) - length(good), profiling, unprofiled))
