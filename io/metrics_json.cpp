// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/metrics_json.h"

#include "core/atomic_file.h"
#include "io/file_bytes.h"
#include "io/json_numbers.h"
#include "io/json_text.h"

#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using Json = nlohmann::ordered_json;

// One list of the plain fields, walked by writer and reader alike.
template <class Metrics, class Visit>
void visit_fields(Metrics& m, Visit&& visit) {
  visit("height_m", m.height_m);
  visit("dbh_m", m.dbh_m);
  visit("dbh_height_m", m.dbh_height_m);
  visit("dbh_coverage", m.dbh_coverage);
  visit("dbh_ellipse_m", m.dbh_ellipse_m);
  visit("stem_volume_m3", m.stem_volume_m3);
  visit("branch_volume_m3", m.branch_volume_m3);
  visit("total_volume_m3", m.total_volume_m3);
  visit("wood_area_m2", m.wood_area_m2);
  visit("total_length_m", m.total_length_m);
  visit("crown_base_m", m.crown_base_m);
  visit("crown_diameter_m", m.crown_diameter_m);
  visit("crown_area_m2", m.crown_area_m2);
  visit("crown_volume_m3", m.crown_volume_m3);
  visit("lean_deg", m.lean_deg);
  visit("lean_azimuth_deg", m.lean_azimuth_deg);
  visit("branch_count_by_order", m.branch_count_by_order);
  visit("length_by_order_m", m.length_by_order_m);
  visit("volume_by_order_m3", m.volume_by_order_m3);
  visit("branch_angle_by_order_deg", m.branch_angle_by_order_deg);
  visit("diameter_class_m", m.diameter_class_m);
  visit("volume_by_diameter_class_m3", m.volume_by_diameter_class_m3);
  visit("wood_share", m.wood_share);
}

template <class Value>
Json to_json(const Value& value) {
  return value;
}

Json to_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <class Value>
void from_json(const Json& json, Value& value) {
  value = json.get<Value>();
}

void from_json(const Json& json, std::optional<double>& value) {
  value = json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

void from_json(const Json& json, std::vector<int>& counts) {
  counts.clear();
  for (const Json& item : json) {
    const std::uint64_t count = whole_number(item);
    if (count > 1'000'000'000) throw std::out_of_range("a count of " + std::to_string(count));
    counts.push_back(static_cast<int>(count));
  }
}

Json object_of(const TreeMetrics& metrics) {
  Json json = Json::object();
  visit_fields(metrics, [&](const char* key, const auto& value) { json[key] = to_json(value); });
  Json taper = Json::array();
  for (const TaperPoint& p : metrics.stem_taper) taper.push_back({p.height_m, p.diameter_m});
  json["stem_taper"] = taper;
  Json layers = Json::array();
  for (const LeafLayer& layer : metrics.leaf_profile)
    layers.push_back({{"from_m", layer.from_m}, {"to_m", layer.to_m}, {"points", layer.points}});
  json["leaf_profile"] = layers;
  Json intervals = Json::object();
  for (const auto& [name, i] : metrics.intervals)
    intervals[name] = {{"value", i.value}, {"lo", i.lo}, {"hi", i.hi}};
  json["intervals"] = intervals;
  return json;
}

}  // namespace

std::string metrics_to_json(const TreeMetrics& metrics, std::span<const TreeMetrics> trees,
                            const std::string& crs) {
  Json json = object_of(metrics);
  if (!crs.empty()) json["crs"] = crs;
  for (const TreeMetrics& tree : trees) json["trees"].push_back(object_of(tree));
  return json_text(json, 1) + "\n";
}

void write_metrics(const std::filesystem::path& path, const TreeMetrics& metrics,
                   std::span<const TreeMetrics> trees, const std::string& crs) {
  write_file(path, metrics_to_json(metrics, trees, crs));
}

namespace {

/// The object of a metrics.json.
Json read_object(const std::filesystem::path& path) {
  const FileBytes bytes(path);
  Json json;
  try {
    json = Json::parse(bytes.view());
  } catch (const Json::parse_error& error) {
    fail_at_byte(path, error.byte, std::string("not JSON: ") + error.what());
  } catch (const Json::exception& error) {  // a number that no double holds
    fail_in_file(path, error.what());
  }
  if (!json.is_object() || !json.contains("height_m"))
    fail_in_file(path, "no object with the key height_m; expected a metrics.json as reconstruct writes it");
  return json;
}

}  // namespace

std::string crs_beside(const std::filesystem::path& tree_model) {
  const std::filesystem::path path = tree_model.parent_path() / "metrics.json";
  if (tree_model.filename() != "qsm.csv" || !std::filesystem::is_regular_file(path)) return {};
  const Json json = read_object(path);
  const auto found = json.find("crs");
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

TreeMetrics metrics_from_json(const std::filesystem::path& path) {
  const Json json = read_object(path);
  TreeMetrics metrics;
  std::string key;
  try {
    visit_fields(metrics, [&](const char* name, auto& value) {
      key = name;
      const auto found = json.find(name);
      // null: not told (a photograph shows no crown volume); the height always is.
      if (found != json.end() && (!found->is_null() || key == "height_m")) from_json(*found, value);
    });
    key = "stem_taper";
    if (const auto taper = json.find(key); taper != json.end() && !taper->is_null())
      for (const Json& pair : *taper)
        metrics.stem_taper.push_back({pair.at(0).get<double>(), pair.at(1).get<double>()});
    key = "leaf_profile";
    if (const auto layers = json.find(key); layers != json.end() && !layers->is_null())
      for (const Json& layer : *layers)
        metrics.leaf_profile.push_back({layer.at("from_m").get<double>(), layer.at("to_m").get<double>(),
                                        layer.at("points").get<std::size_t>()});
    key = "intervals";
    if (const auto intervals = json.find(key); intervals != json.end())
      for (const auto& [name, i] : intervals->items())
        metrics.intervals[name] = {i.at("value").get<double>(), i.at("lo").get<double>(),
                                   i.at("hi").get<double>()};
  } catch (const std::exception& error) {
    fail_in_file(path, "key '" + key + "': " + error.what());
  }
  return metrics;
}

}  // namespace dendrofit
