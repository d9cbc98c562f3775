// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/site_file.h"

#include "cli/igm_files.h"
#include "core/errors.h"
#include "io/read_mesh.h"
#include "io/toml.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

/// What `read` gives; what it complains of, led by the place in the site file that names it.
template <class Read>
auto at(const TomlEntry& entry, const fs::path& file, Read read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(toml_place(file, entry) + ": " + error.what());
  } catch (const IoError& error) {
    throw IoError(toml_place(file, entry) + ": " + error.what());
  }
}

Vec3 triple(const TomlEntry& entry, const fs::path& file) {
  const auto v = toml_numbers(entry, file.string());
  if (v.size() != 3)
    throw InputError(
        fmt::format("{}: {} has {} numbers; expected x, y, z", toml_place(file, entry), entry.key, v.size()));
  return {v[0], v[1], v[2]};
}

/// Entries of one [[name]] block, keys without the block's prefix.
using Blocks = std::map<std::pair<std::string, int>, std::vector<TomlEntry>>;

Blocks blocks_of(const fs::path& file) {
  Blocks blocks;
  for (TomlEntry& entry : read_toml_without_empty_tables(file)) {
    const auto first = entry.key.find('.');
    const auto second = first == std::string::npos ? first : entry.key.find('.', first + 1);
    const std::string name = entry.key.substr(0, first);
    if (second == std::string::npos ||
        (name != "tree" && name != "box" && name != "halfspace" && name != "mesh"))
      throw InputError(fmt::format("{}: '{}' is not part of a [[tree]], [[box]], [[halfspace]] or [[mesh]]",
                                   toml_place(file, entry), entry.key));
    const int index = std::stoi(entry.key.substr(first + 1, second - first - 1));
    entry.key = entry.key.substr(second + 1);
    blocks[{name, index}].push_back(std::move(entry));
  }
  return blocks;
}

[[noreturn]] void unknown_key(const fs::path& file, const TomlEntry& entry, const std::string& block,
                              const std::string& known) {
  throw InputError(fmt::format("{}: [[{}]] has no key '{}'; expected {}", toml_place(file, entry), block,
                               entry.key, known));
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
                                     toml_place(file, entry), v.size()));
      for (std::size_t i = 0; i < v.size(); i += 3) tree.roots.emplace_back(v[i], v[i + 1], v[i + 2]);
    } else if (entry.key == "parameters") {
      const std::string name = toml_text(entry, file.string());
      const fs::path beside = file.parent_path() / name;
      tree.parameters = at(entry, file, [&] {
        return load_igm_setup(fs::exists(beside) ? beside.string() : name).parameters;
      });
    } else if (entry.key.starts_with("parameters.")) {
      own.push_back(entry);
      own.back().key.erase(0, std::string_view("parameters.").size());
    } else {
      unknown_key(file, entry, "tree", "root, parameters");
    }
  }
  if (tree.roots.empty()) throw InputError(file.string() + ": a [[tree]] has no root = [x, y, z]");
  if (!own.empty()) tree.parameters = igm_parameters_from(own, file, common);
  return tree;
}

std::vector<double> numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

SiteFile load_site(const fs::path& file, const IgmParameters& parameters) {
  SiteFile loaded;
  IgmSite& site = loaded.site;
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
      const fs::path mesh = given.is_absolute() ? given : file.parent_path() / given;
      site.solids.meshes.push_back(at(block["file"], file, [&] { return read_mesh(mesh); }));
      loaded.mesh_files.push_back(mesh);
    }
  }
  try {
    site.validate();
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  return loaded;
}

std::string site_toml(const SiteFile& loaded, const fs::path& folder) {
  const IgmSite& site = loaded.site;
  TomlWriter toml;
  for (const IgmTreeSite& tree : site.trees) {
    std::vector<double> roots;
    for (const Vec3& root : tree.roots) roots.insert(roots.end(), root.data(), root.data() + 3);
    toml.array_table("tree").entry("root", TomlValue(roots), "x, y, z in metres, for each stem");
    if (!tree.parameters) continue;
    toml.table("tree.parameters");
    write_parameters(*tree.parameters, toml);
  }
  for (const SolidBox& box : site.solids.boxes)
    toml.array_table("box")
        .entry("min", TomlValue(numbers(box.min)))
        .entry("max", TomlValue(numbers(box.max)));
  for (const SolidHalfSpace& half : site.solids.half_spaces)
    toml.array_table("halfspace")
        .entry("point", TomlValue(numbers(half.point)))
        .entry("normal", TomlValue(numbers(half.normal)));
  for (const fs::path& mesh : loaded.mesh_files)
    toml.array_table("mesh").entry("file", TomlValue(fs::proximate(mesh, folder).generic_string()));
  return toml.text();
}

}  // namespace dendrofit::cli
