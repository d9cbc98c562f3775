// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/igm_files.h"

#include "core/errors.h"
#include "io/read_mesh.h"
#include "io/toml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

std::string place(const fs::path& file, const TomlEntry& entry) {
  return fmt::format("{}, line {}", file.string(), entry.line);
}

double number_or_truth(const TomlEntry& entry, const std::string& file) {
  return std::holds_alternative<bool>(entry.value) ? double(std::get<bool>(entry.value))
                                                   : toml_number(entry, file);
}

/// Sets what `entries` say on `parameters`; the equation first, since its own parameters depend on it.
void apply_entries(IgmParameters& parameters, const std::vector<TomlEntry>& entries, const fs::path& file) {
  for (const TomlEntry& entry : entries)
    if (entry.key == "equation") parameters.set_equation(toml_text(entry, file.string()), place(file, entry));
  for (const TomlEntry& entry : entries) {
    if (entry.key == "equation" || entry.key == "preset") continue;
    parameters.set(entry.key, number_or_truth(entry, file.string()), place(file, entry));
  }
}

IgmParameters from_entries(const std::vector<TomlEntry>& entries, const fs::path& file,
                           IgmParameters parameters) {
  for (const TomlEntry& entry : entries)
    if (entry.key == "preset") parameters = igm_preset(toml_text(entry, file.string())).parameters;
  apply_entries(parameters, entries, file);
  try {
    parameters.validate();
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  return parameters;
}

Vec3 triple(const TomlEntry& entry, const fs::path& file) {
  const auto v = toml_numbers(entry, file.string());
  if (v.size() != 3)
    throw InputError(
        fmt::format("{}: {} has {} numbers; expected x, y, z", place(file, entry), entry.key, v.size()));
  return {v[0], v[1], v[2]};
}

/// Entries of one [[name]] block, keys without the block's prefix.
using Blocks = std::map<std::pair<std::string, int>, std::vector<TomlEntry>>;

Blocks blocks_of(const fs::path& file) {
  Blocks blocks;
  for (TomlEntry& entry : read_toml(file)) {
    const auto first = entry.key.find('.');
    const auto second = first == std::string::npos ? first : entry.key.find('.', first + 1);
    const std::string name = entry.key.substr(0, first);
    if (second == std::string::npos ||
        (name != "tree" && name != "box" && name != "halfspace" && name != "mesh"))
      throw InputError(fmt::format("{}: '{}' is not part of a [[tree]], [[box]], [[halfspace]] or [[mesh]]",
                                   place(file, entry), entry.key));
    const int index = std::stoi(entry.key.substr(first + 1, second - first - 1));
    entry.key = entry.key.substr(second + 1);
    blocks[{name, index}].push_back(std::move(entry));
  }
  return blocks;
}

[[noreturn]] void unknown_key(const fs::path& file, const TomlEntry& entry, const std::string& block,
                              const std::string& known) {
  throw InputError(
      fmt::format("{}: [[{}]] has no key '{}'; expected {}", place(file, entry), block, entry.key, known));
}

/// One block of a site file, all of whose keys are needed.
struct Block {
  const fs::path& file;
  const std::string& name;
  const std::vector<TomlEntry>& entries;

  void expect(const std::vector<std::string>& keys) const {
    const std::string known = fmt::format("{}", fmt::join(keys, ", "));
    for (const TomlEntry& entry : entries)
      if (std::find(keys.begin(), keys.end(), entry.key) == keys.end()) unknown_key(file, entry, name, known);
    for (const std::string& key : keys)
      if (!find(key))
        throw InputError(fmt::format("{}: a [[{}]] has no {}; it needs {}", file.string(), name, key, known));
  }
  const TomlEntry& operator[](const std::string& key) const { return *find(key); }

 private:
  const TomlEntry* find(const std::string& key) const {
    const auto found = std::find_if(entries.begin(), entries.end(),
                                    [&](const TomlEntry& entry) { return entry.key == key; });
    return found == entries.end() ? nullptr : &*found;
  }
};

IgmTreeSite tree_site(const std::vector<TomlEntry>& entries, const fs::path& file,
                      const IgmParameters& common) {
  IgmTreeSite tree;
  std::vector<TomlEntry> own;
  for (const TomlEntry& entry : entries) {
    if (entry.key == "root") {
      const auto v = toml_numbers(entry, file.string());
      if (v.empty() || v.size() % 3 != 0)
        throw InputError(fmt::format("{}: root has {} numbers; expected x, y, z for each stem",
                                     place(file, entry), v.size()));
      for (std::size_t i = 0; i < v.size(); i += 3) tree.roots.emplace_back(v[i], v[i + 1], v[i + 2]);
    } else if (entry.key == "parameters") {
      const std::string name = toml_text(entry, file.string());
      const fs::path beside = file.parent_path() / name;
      tree.parameters = load_igm_parameters(fs::exists(beside) ? beside.string() : name);
    } else if (entry.key.starts_with("parameters.")) {
      own.push_back(entry);
      own.back().key.erase(0, std::string_view("parameters.").size());
    } else {
      unknown_key(file, entry, "tree", "root, parameters");
    }
  }
  if (tree.roots.empty()) throw InputError(file.string() + ": a [[tree]] has no root = [x, y, z]");
  if (!own.empty()) tree.parameters = from_entries(own, file, common);
  return tree;
}

}  // namespace

IgmParameters load_igm_parameters(const std::string& preset_or_file) {
  const fs::path file = preset_or_file;
  if (file.extension() != ".toml" && !fs::is_regular_file(file)) return igm_preset(preset_or_file).parameters;
  return from_entries(read_toml(file), file, IgmParameters{});
}

void apply_settings(IgmParameters& parameters, const std::vector<std::string>& settings) {
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
    entries.push_back(std::move(entry));
  }
  for (const TomlEntry& entry : entries)
    if (entry.key == "equation") parameters.set_equation(toml_text(entry, "--set"), "--set");
  for (const TomlEntry& entry : entries) {
    if (entry.key == "equation") continue;
    if (std::holds_alternative<std::string>(entry.value))
      throw InputError("--set " + entry.key + ": '" + std::get<std::string>(entry.value) +
                       "' is not a number");
    parameters.set(entry.key, number_or_truth(entry, "--set"), "--set");
  }
}

std::string igm_parameters_toml(const IgmParameters& parameters, const std::vector<std::string>& remarks) {
  TomlWriter toml;
  for (const std::string& remark : remarks) toml.comment(remark);
  toml.entry("equation", TomlValue(parameters.equation));
  for (const ParameterSpec& spec : igm_parameter_table(parameters.equation)) {
    const double value = parameters.get(spec.key);
    const std::string remark =
        spec.unit.empty() ? std::string(spec.meaning) : fmt::format("{}: {}", spec.unit, spec.meaning);
    toml.entry(spec.key, TomlValue(value), remark);
  }
  return toml.text();
}

IgmSite load_site(const fs::path& file, const IgmParameters& parameters) {
  IgmSite site;
  for (const auto& [id, entries] : blocks_of(file)) {
    const std::string& name = id.first;
    const Block block{file, name, entries};
    if (name == "tree") {
      site.trees.push_back(tree_site(entries, file, parameters));
    } else if (name == "box") {
      block.expect({"min", "max"});
      site.solids.boxes.push_back({triple(block["min"], file), triple(block["max"], file)});
    } else if (name == "halfspace") {
      block.expect({"point", "normal"});
      site.solids.half_spaces.push_back({triple(block["point"], file), triple(block["normal"], file)});
    } else {
      block.expect({"file"});
      const fs::path given = toml_text(block["file"], file.string());
      site.solids.meshes.push_back(read_mesh(given.is_absolute() ? given : file.parent_path() / given));
    }
  }
  site.validate();
  return site;
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
