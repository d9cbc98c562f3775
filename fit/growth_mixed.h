// SPDX-License-Identifier: GPL-3.0-or-later
// Mixed-effects growth curves: a population curve, and an asymptote (and rate) that vary from series to
// series.
#pragma once

#include "core/measurements.h"
#include "core/progress.h"
#include "fit/growth_options.h"
#include "fit/growth_result.h"

#include <string>
#include <vector>

namespace dendrofit {

/// Maximum likelihood by alternating penalised nonlinear least squares and a linear mixed model of the
/// linearised curve (Lindstrom & Bates 1990, Biometrics 46:673), so that log-likelihoods compare with those
/// of nlme. Random effects are normal and additive on the asymptote (and the rate; for equations with a scale
/// age L instead of a rate, on ln L). Asks for two series or more; otherwise, and where the iteration does
/// not settle, the result's status and reason say so. Throws InputError for options that cannot be right,
/// among them options.mixed == none.
GrowthMixed fit_mixed_growth(const std::vector<MeasurementSeries>& series, const std::string& equation,
                             const GrowthOptions& options, Progress& progress = no_progress());

}  // namespace dendrofit
