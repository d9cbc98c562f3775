// SPDX-License-Identifier: GPL-3.0-or-later
// Growth equations fitted to one series of measurements or thousands: each alone, all pooled, and as a mixed
// model.
#pragma once

#include "core/measurements.h"
#include "core/progress.h"
#include "fit/growth_options.h"
#include "fit/growth_result.h"

#include <vector>

namespace dendrofit {

/// Fits every equation of the options to every series, in parallel; the same result for any number of
/// threads. A series that cannot be fitted never stops the others: its fits carry status and reason, and the
/// report's warnings name it. With several series also the pooled fit and, where the options ask for it, the
/// mixed models. Series keep their order. Throws InputError for options that cannot be right or for no series
/// at all, Cancelled when the user stops it.
GrowthReport fit_growth(const std::vector<MeasurementSeries>& series, const GrowthOptions& options = {},
                        Progress& progress = no_progress());

}  // namespace dendrofit
