// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/leaves_output.h"

#include "io/json_text.h"

#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

using Json = nlohmann::ordered_json;

Json ks_json(const KsResult& ks) {
  return {{"distance", ks.distance}, {"p_value", ks.p_value}, {"n", ks.samples}};
}

Json distribution_json(const LeafDistribution& d) {
  return {{"unit", d.unit},
          {"edges", d.edges},
          {"requested", d.requested},
          {"candidates", d.candidates},
          {"achieved", d.achieved},
          {"ks_before_rejection", ks_json(d.before)},
          {"ks_after_rejection", ks_json(d.after)}};
}

Json bin_json(const LeafBudgetBin& bin) {
  return {{"from_m", bin.from_m},
          {"to_m", bin.to_m},
          {"requested_area_m2", bin.requested_m2},
          {"achieved_area_m2", bin.achieved_m2},
          {"candidates", bin.tried},
          {"placed", bin.placed},
          {"poses_refused",
           {{"wood", bin.refused_by_wood}, {"leaf", bin.refused_by_leaf}, {"ground", bin.refused_by_ground}}},
          {"reason", bin.reason}};
}

}  // namespace

std::string leaves_json(const LeafResult& result, const std::string& crs) {
  const LeafReport& r = result.report;
  Json json;
  json["species"] = result.foliage.species;
  json["source"] = r.source;
  json["target"] = r.target;
  json["seed"] = r.seed;
  json["clearance_m"] = r.clearance_m;
  json["requested"] = {
      {"area_m2", r.requested_area_m2}, {"count", r.requested_count}, {"lai", r.requested_lai}};
  json["achieved"] = {{"area_m2", r.achieved_area_m2}, {"count", r.achieved_count}, {"lai", r.lai}};
  json["shortfall"] = {{"area_m2", r.shortfall_m2}, {"reason", r.shortfall_reason}};
  json["crown_area_m2"] = r.crown_area_m2;
  json["bearing_wood"] = {{"length_m", r.bearing_length_m},
                          {"max_radius_m", r.bearing_radius_m},
                          {"added_twigs_m", r.added_twigs_m}};
  Json& distributions = json["distributions"] = Json::object();
  for (const LeafDistribution& d : r.distributions) distributions[d.name] = distribution_json(d);
  Json& bins = json["height_bins"] = Json::array();
  for (const LeafBudgetBin& bin : r.bins) bins.push_back(bin_json(bin));
  json["leaf_area_density"] = {{"step_m", r.profile_step_m}, {"m2_per_m", r.leaf_area_density}};
  Json voxels = Json::array();
  for (const LeafVoxel& v : r.voxels)
    voxels.push_back({v.index[0], v.index[1], v.index[2], v.density_m2_per_m3});
  json["voxels"] = {
      {"edge_m", r.voxel_m},
      {"origin_m",
       {result.foliage.origin_shift.x(), result.foliage.origin_shift.y(), result.foliage.origin_shift.z()}},
      {"columns", {"i", "j", "k", "m2_per_m3"}},
      {"values", voxels}};
  json["g_function"] = {{"zenith_deg", {0, 10, 20, 30, 40, 50, 60, 70, 80, 90}}, {"value", r.g_function}};
  json["gap_fraction"] = r.gap_fraction;
  json["clumping"] = r.clumping;
  json["work"] = {{"candidates", r.candidates},
                  {"poses", r.poses},
                  {"leaf_pair_tests", r.leaf_pair_tests},
                  {"wood_tests", r.wood_tests},
                  {"rounds", r.rounds}};
  if (!crs.empty()) json["crs"] = crs;
  json["seconds"] = r.seconds;
  json["warnings"] = r.warnings;
  return json_text(json) + "\n";
}

}  // namespace dendrofit::cli
