# SPDX-License-Identifier: GPL-3.0-or-later
# Reads a result folder of dendrofit.  usage: Rscript read_results.R FOLDER   (apt-get install r-base-core r-cran-jsonlite)
folder <- commandArgs(trailingOnly = TRUE)[1]
qsm <- read.csv(file.path(folder, "qsm.csv"))  # one row a cylinder, metres
metrics <- jsonlite::fromJSON(file.path(folder, "metrics.json"))
qsm$volume_m3 <- pi * qsm$radius^2 * qsm$length
print(aggregate(cbind(length, volume_m3) ~ order, data = qsm, FUN = sum))
cat("cylinders", nrow(qsm), "volume_m3", round(sum(qsm$volume_m3), 6), "height_m", round(metrics$height_m, 3), "\n")
stopifnot(abs(sum(qsm$volume_m3) - metrics$total_volume_m3) <= 1e-6 * metrics$total_volume_m3 + 1e-9)
