// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/leaf_settings.h"

#include "cli/parse.h"
#include "core/errors.h"

#include <fmt/format.h>

namespace dendrofit::cli {

void LeafSettings::declare(OptionTable& options) {
  options.choice("--species", species, leaf_species(), "Leaf shape, size and arrangement");
  options.number("--area", area_m2, Quantity::area, "One-sided leaf area to reach");
  options.number("--lai", lai, Quantity::pure, "Leaf area over crown projection to reach");
  options.integer("--count", count, "Number of leaves to reach");
  options.number("--season", season, Quantity::pure, "Share of the leaves that are out, 0 to 1");
}

LeafOptions LeafSettings::resolve(const CommonOptions& common) const {
  if (int(area_m2.has_value()) + int(lai.has_value()) + int(count.has_value()) > 1)
    throw UsageError("give one of --area, --lai and --count, not several");
  LeafOptions options;
  options.traits = leaf_traits(species);
  options.area_m2 = area_m2;
  options.lai = lai;
  if (count) {
    require(*count >= 0, "--count", *count, "must not be negative");
    options.count = static_cast<std::size_t>(*count);
  }
  options.season = season;
  options.seed = common.seed;
  options.threads = common.threads;
  options.validate();
  return options;
}

void say_leaves(const Session& session, const LeafResult& result) {
  const LeafReport& r = result.report;
  session.say(fmt::format("  leaves      {} ({:.4g} m2, LAI {:.2f}), no two touch each other or the wood",
                          r.achieved_count, r.achieved_area_m2, r.lai));
  if (r.shortfall_m2 > 0)
    session.say(fmt::format("  shortfall   {:.4g} of {:.4g} m2: {}", r.shortfall_m2, r.requested_area_m2,
                            r.shortfall_reason));
  for (const std::string& warning : r.warnings) session.warn(warning);
}

}  // namespace dendrofit::cli
