// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/igm_files.h"

#include "core/errors.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kMostRoots = 1000;

double number_or_truth(const TomlEntry& entry, const std::string& file) {
  return std::holds_alternative<bool>(entry.value) && IgmParameters::is_switch(entry.key)
             ? double(std::get<bool>(entry.value))
             : toml_number(entry, file);
}

int number_of_roots(double value, const std::string& where) {
  if (!(value >= 1 && value <= kMostRoots) || value != static_cast<int>(value))
    throw InputError(
        fmt::format("{}: roots = {}: must be a whole number between 1 and {}", where, value, kMostRoots));
  return static_cast<int>(value);
}

const IgmPreset& preset_of(const TomlEntry& entry, const fs::path& file) {
  try {
    return igm_preset(toml_text(entry, file.string()));
  } catch (const InputError& error) {
    throw InputError(toml_place(file, entry) + ": " + error.what());
  }
}

[[noreturn]] void refuse_table(const TomlEntry& entry, const fs::path& file) {
  const std::string table = entry.key.substr(0, entry.key.find('.'));
  const bool of_a_site = table == "tree" || table == "box" || table == "halfspace" || table == "mesh";
  throw InputError(
      fmt::format("{}: '{}' is in a table; a parameter file has none: {}", toml_place(file, entry), entry.key,
                  of_a_site ? "trees and obstacles belong in a file of their own, given with --site"
                            : "write the key by itself"));
}

}  // namespace

std::string toml_place(const fs::path& file, const TomlEntry& entry) {
  return fmt::format("{}, line {}", file.string(), entry.line);
}

IgmParameters igm_parameters_from(const std::vector<TomlEntry>& entries, const fs::path& file,
                                  IgmParameters parameters) {
  // What they start from first, then the equation, since its own parameters depend on it.
  for (const TomlEntry& entry : entries)
    if (entry.key == "preset") parameters = preset_of(entry, file).parameters;
  for (const TomlEntry& entry : entries)
    if (entry.key == "equation")
      parameters.set_equation(toml_text(entry, file.string()), toml_place(file, entry));
  for (const TomlEntry& entry : entries)
    if (entry.key != "equation" && entry.key != "preset")
      parameters.set(entry.key, number_or_truth(entry, file.string()), toml_place(file, entry));
  try {
    parameters.validate();
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  return parameters;
}

IgmSetup load_igm_setup(const std::string& preset_or_file) {
  const fs::path file = preset_or_file;
  if (file.extension() != ".toml" && !fs::is_regular_file(file)) {
    const IgmPreset& preset = igm_preset(preset_or_file);
    return {preset.parameters, preset.roots, {}};
  }
  IgmSetup setup;
  std::vector<TomlEntry> entries = read_toml_without_empty_tables(file);
  for (const TomlEntry& entry : entries) {
    if (entry.key.find('.') != std::string::npos) refuse_table(entry, file);
    if (entry.key == "preset") setup.roots = preset_of(entry, file).roots;
  }
  std::erase_if(entries, [&](const TomlEntry& entry) {
    if (entry.key == "roots") {
      setup.roots = number_of_roots(toml_number(entry, file.string()), toml_place(file, entry));
    } else if (entry.key == "site") {
      const fs::path site = toml_text(entry, file.string());
      setup.site = site.is_absolute() ? site : file.parent_path() / site;
    } else {
      return false;
    }
    return true;
  });
  setup.parameters = igm_parameters_from(entries, file, setup.parameters);
  return setup;
}

void apply_settings(IgmSetup& setup, const std::vector<std::string>& settings) {
  std::vector<TomlEntry> entries;
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError("--set " + setting + ": expected key=value, e.g. --set xm=80");
    TomlEntry entry{setting.substr(0, equals), {}, 0};
    const std::string value = setting.substr(equals + 1);
    double number = 0;
    const auto [rest, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (value == "true" || value == "false")
      entry.value = value == "true";
    else if (error == std::errc() && rest == value.data() + value.size())
      entry.value = number;
    else
      entry.value = value;
    if (entry.key == "equation")
      setup.parameters.set_equation(value, "--set");
    else
      entries.push_back(std::move(entry));
  }
  for (const TomlEntry& entry : entries) {
    if (entry.key == "preset" || entry.key == "site")
      throw InputError(fmt::format("--set {0}: a {0} is not a number to set; {1}", entry.key,
                                   entry.key == "site" ? "give the file with --site"
                                                       : "give its name in place of the parameter file"));
    if (std::holds_alternative<std::string>(entry.value))
      throw InputError("--set " + entry.key + ": '" + std::get<std::string>(entry.value) +
                       "' is not a number");
    if (std::holds_alternative<bool>(entry.value) && !IgmParameters::is_switch(entry.key))
      throw InputError("--set " + entry.key + ": true or false found, a number expected");
    const double value = number_or_truth(entry, "--set");
    if (entry.key == "roots")
      setup.roots = number_of_roots(value, "--set");
    else
      setup.parameters.set(entry.key, value, "--set");
  }
}

void write_parameters(const IgmParameters& parameters, TomlWriter& toml) {
  toml.entry("equation", TomlValue(parameters.equation));
  for (const ParameterSpec& spec : igm_parameter_table(parameters.equation)) {
    const double value = parameters.get(spec.key);
    const std::string remark =
        spec.unit.empty() ? std::string(spec.meaning) : fmt::format("{}: {}", spec.unit, spec.meaning);
    toml.entry(spec.key, TomlValue(value), remark);
  }
}

std::string igm_setup_toml(const IgmSetup& setup, const std::vector<std::string>& remarks) {
  TomlWriter toml;
  for (const std::string& remark : remarks) toml.comment(remark);
  write_parameters(setup.parameters, toml);
  if (!setup.site.empty())
    toml.entry("site", TomlValue(setup.site.generic_string()), "trees and obstacles, a file beside this one");
  else if (setup.roots > 1)
    toml.entry("roots", TomlValue(std::int64_t{setup.roots}),
               "stems of a shrub, in a ring two internodes apart");
  return toml.text();
}

std::string igm_parameters_toml(const IgmParameters& parameters, const std::vector<std::string>& remarks) {
  return igm_setup_toml({parameters, 1, {}}, remarks);
}

std::string growth_series_csv(const std::vector<GrowthRecord>& series) {
  const bool several =
      std::any_of(series.begin(), series.end(), [](const GrowthRecord& r) { return r.tree > 0; });
  std::string csv =
      "cycle,height_m,dbh_m,stem_internodes,internodes,axes,living_buds,shed_internodes,light_mean,length_m,"
      "volume_m3";
  csv += several ? ",tree\n" : "\n";
  for (const GrowthRecord& r : series) {
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{}", r.cycle, r.height_m,
                       r.dbh_m ? fmt::format("{}", *r.dbh_m) : "", r.stem_internodes, r.internodes, r.axes,
                       r.living_buds, r.shed_internodes, r.light_mean, r.length_m, r.volume_m3);
    csv += several ? fmt::format(",{}\n", r.tree + 1) : "\n";
  }
  return csv;
}

}  // namespace dendrofit::cli
