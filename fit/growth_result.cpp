// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_result.h"

#include <algorithm>

namespace dendrofit {

std::string growth_status_name(GrowthStatus status) {
  switch (status) {
    case GrowthStatus::ok:
      return "ok";
    case GrowthStatus::no_finite_optimum:
      return "no_finite_optimum";
    case GrowthStatus::too_few_points:
      return "too_few_points";
    case GrowthStatus::ill_conditioned:
      return "ill_conditioned";
    case GrowthStatus::failed:
      break;
  }
  return "failed";
}

const GrowthParameter* GrowthFit::parameter(const std::string& name) const {
  const auto at =
      std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; });
  return at == parameters.end() ? nullptr : &*at;
}

const GrowthFit* GrowthSeries::fit(const std::string& equation) const {
  const auto at =
      std::find_if(fits.begin(), fits.end(), [&](const auto& f) { return f.equation == equation; });
  return at == fits.end() ? nullptr : &*at;
}

bool GrowthReport::any_ok() const {
  const auto ok = [](const GrowthSeries& one) {
    return std::any_of(one.fits.begin(), one.fits.end(),
                       [](const auto& f) { return f.status == GrowthStatus::ok; });
  };
  return std::any_of(series.begin(), series.end(), ok) || (pooled && ok(*pooled)) ||
         std::any_of(mixed.begin(), mixed.end(), [](const auto& m) { return m.status == GrowthStatus::ok; });
}

}  // namespace dendrofit
