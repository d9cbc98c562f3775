// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/leaf_settings.h"

#include "cli/leaf_laws.h"
#include "cli/parse.h"
#include "core/errors.h"
#include "forward/leaves/leaf_shapes.h"
#include "io/read_mesh.h"

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

/// The law with another mean, all its lengths in proportion.
LengthLaw scaled(LengthLaw law, double mean_m) {
  require(mean_m > 0 && mean_m <= 4, "--leaf-length", mean_m, "must be above 0 and at most 4 m");
  const double factor = mean_m / law.mean_m;
  for (double* length : {&law.mean_m, &law.sd_m, &law.min_m, &law.max_m}) *length *= factor;
  return law;
}

}  // namespace

void LeafSettings::declare(OptionTable& options) {
  options.choice("--species", species, leaf_species(), "Leaf shape, size and arrangement");
  options.number("--area", area_m2, Quantity::area, "One-sided leaf area to reach");
  options.number("--lai", lai, Quantity::pure, "Leaf area over crown projection to reach");
  options.integer("--count", count, "Number of leaves to reach");
  options.number("--season", season, Quantity::pure, "Share of the leaves that are out, 0 to 1");
  options.path("--leaf-mesh", blade,
               "A blade of your own (.obj, .ply): petiole at the origin, +y to the tip, +z up");
  options.number("--leaf-length", length_m, Quantity::length, "Mean blade length (default: the species')");
  options.text(
      "--inclination", inclination, "LAW",
      "How steep leaves stand (default: the species'): planophile, erectophile, plagiophile, extremophile, "
      "uniform, spherical, beta:A,B, ellipsoidal:RATIO, table:W1,W2,...");
  options.texts(
      "--profile", profile, "PLACE=LAW",
      "Where leaf area sits: height, along-axis, compass, radius, order or tip-distance, as uniform, "
      "beta:A,B, "
      "weibull:SCALE,SHAPE, von-mises:MEAN,KAPPA, table:W1,W2,... or a sum 0.3*LAW+0.7*LAW; may be repeated");
  options.number("--clearance", clearance_m, Quantity::length, "Distance that leaves keep, at least 0.1 mm");
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
  if (!blade.empty()) {
    options.traits.shapes = {{leaf_shape_from_mesh(read_mesh(blade), blade.stem().string()), 1}};
    options.traits.source += "; blade: " + blade.filename().string();
  }
  if (length_m) options.traits.length = scaled(options.traits.length, *length_m);
  if (!inclination.empty()) options.traits.inclination = inclination_law_from(inclination, "--inclination");
  for (const std::string& entry : profile) set_profile(entry, options.profile);
  options.clearance_m = clearance_m;
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
