// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report_file.h"

#include "io/file_bytes.h"
#include "io/json_numbers.h"
#include "io/json_text.h"

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

using Json = nlohmann::ordered_json;

// How each kind of value is written and read; what is not finite, or absent, is null.
Json written(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json written(const std::string& value) {
  return value;
}
Json written(bool value) {
  return value;
}
Json written(std::uint64_t value) {
  return value;
}
template <class Value>
Json written(const std::optional<Value>& value) {
  return value ? written(*value) : Json(nullptr);
}
template <class First, class Second>
Json written(const std::pair<First, Second>& pair) {
  return Json::array({written(pair.first), written(pair.second)});
}
template <class Value>
Json written(const std::vector<Value>& list);

void read(const Json& json, double& value) {
  value = json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}
void read(const Json& json, std::string& value) {
  value = json.get<std::string>();
}
void read(const Json& json, bool& value) {
  value = json.get<bool>();
}
void read(const Json& json, std::uint64_t& value) {
  value = whole_number(json);
}
template <class Value>
void read(const Json& json, std::optional<Value>& value) {
  value.reset();
  if (!json.is_null()) read(json, value.emplace());
}
template <class First, class Second>
void read(const Json& json, std::pair<First, Second>& pair) {
  read(json.at(0), pair.first);
  read(json.at(1), pair.second);
}
template <class Value>
void read(const Json& json, std::vector<Value>& list);

// One list of the fields of each part, walked by writer and reader alike.
template <class Part, class Visit>
requires std::same_as<std::remove_const_t<Part>, ReportParameter>
void visit_fields(Part& p, Visit&& visit) {
  visit("key", p.key);
  visit("symbol", p.symbol);
  visit("unit", p.unit);
  visit("meaning", p.meaning);
  visit("value", p.value);
  visit("lo", p.lo);
  visit("hi", p.hi);
  visit("prior_lo", p.prior_lo);
  visit("prior_hi", p.prior_hi);
  visit("identifiable", p.identifiable);
  visit("fixed", p.fixed);
}
template <class Part, class Visit>
requires std::same_as<std::remove_const_t<Part>, ReportCurve>
void visit_fields(Part& c, Visit&& visit) {
  visit("name", c.name);
  visit("value_unit", c.value_unit);
  visit("time_unit", c.time_unit);
  visit("time", c.time);
  visit("value", c.value);
  visit("cap", c.cap);
  visit("lo", c.lo);
  visit("hi", c.hi);
  visit("measured", c.measured);
  visit("band", c.band);
}
template <class Part, class Visit>
requires std::same_as<std::remove_const_t<Part>, ReportDescriptor>
void visit_fields(Part& d, Visit&& visit) {
  visit("name", d.name);
  visit("before", d.before);
  visit("after", d.after);
}
template <class Part, class Visit>
requires std::same_as<std::remove_const_t<Part>, ReportStage>
void visit_fields(Part& s, Visit&& visit) {
  visit("name", s.name);
  visit("seconds", s.seconds);
}
template <class Part, class Visit>
requires std::same_as<std::remove_const_t<Part>, ReportProvenance>
void visit_fields(Part& p, Visit&& visit) {
  visit("program", p.program);
  visit("version", p.version);
  visit("seed", p.seed);
  visit("command_line", p.command_line);
  visit("input_name", p.input_name);
  visit("input_checksum", p.input_checksum);
  visit("crs", p.crs);
  visit("options", p.options);
  visit("stages", p.stages);
}
template <class Part, class Visit>
requires std::same_as<std::remove_const_t<Part>, ReportData>
void visit_fields(Part& d, Visit&& visit) {
  visit("title", d.title);
  visit("growth_model", d.growth_model);
  visit("fit_status", d.fit_status);
  visit("parameters", d.parameters);
  visit("curves", d.curves);
  visit("descriptors", d.descriptors);
  visit("cost_by_evaluation", d.cost_by_evaluation);
  visit("leaf_facts", d.leaf_facts);
  visit("warnings", d.warnings);
  visit("provenance", d.provenance);
}

template <class Part>
concept HasFields = requires(Part& part) {
  visit_fields(part, [](const char*, auto&) {});
};

template <HasFields Part>
Json written(const Part& part) {
  Json json = Json::object();
  visit_fields(part, [&](const char* key, const auto& value) { json[key] = written(value); });
  return json;
}
template <class Value>
Json written(const std::vector<Value>& list) {
  Json json = Json::array();
  for (const Value& value : list) json.push_back(written(value));
  return json;
}
template <HasFields Part>
void read(const Json& json, Part& part) {
  visit_fields(part, [&](const char* key, auto& value) { read(json.at(key), value); });
}
template <class Value>
void read(const Json& json, std::vector<Value>& list) {
  list.clear();
  for (const Json& item : json) read(item, list.emplace_back());
}

}  // namespace

std::string report_json(const ReportData& data) {
  return json_text(written(data), 1) + "\n";
}

void read_report_json(const std::filesystem::path& path, ReportData& data) {
  const FileBytes bytes(path);
  try {
    read(Json::parse(bytes.view()), data);
  } catch (const Json::parse_error& error) {
    fail_at_byte(path, error.byte, std::string("not JSON: ") + error.what());
  } catch (const Json::exception& error) {
    fail_in_file(path, std::string("no report.json as run and fit write it: ") + error.what());
  }
}

}  // namespace dendrofit::cli
