// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/output_folder.h"

#include "cli/parse.h"
#include "cli/version.h"
#include "core/errors.h"
#include "io/toml.h"

#include <array>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <zlib.h>

namespace dendrofit::cli {

namespace fs = std::filesystem;

void need_output(const fs::path& output) {
  if (output.empty()) throw UsageError("no output folder: give one with -o FOLDER");
}

fs::path prepare_output_folder(const fs::path& folder, const CommonOptions& common) {
  need_output(folder);
  std::error_code error;
  if (fs::exists(folder, error)) {
    if (!fs::is_directory(folder)) throw IoError(folder.string() + ": is a file; -o wants a folder");
    if (!fs::is_empty(folder) && !common.force)
      throw UsageError(folder.string() +
                       ": this folder holds files already; give --force to overwrite results in it");
    return folder;
  }
  fs::create_directories(folder, error);
  if (error) throw IoError(folder.string() + ": cannot be made (" + error.message() + ")");
  return folder;
}

void prepare_output_file(const fs::path& file, const CommonOptions& common) {
  std::error_code error;
  if (fs::is_directory(file, error)) throw IoError(file.string() + ": is a folder; give a file name");
  if (fs::exists(file, error) && !common.force)
    throw UsageError(file.string() + ": exists already; give --force to overwrite it");
  const fs::path folder = file.parent_path();
  if (!folder.empty() && !fs::is_directory(folder, error))
    throw IoError(folder.string() + ": no such folder; make it first");
}

std::string checksum(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw IoError(file.string() + ": cannot be read");
  uLong crc = crc32(0, nullptr, 0);
  std::array<char, 1 << 16> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0)
    crc = crc32(crc, reinterpret_cast<const Bytef*>(block.data()), static_cast<uInt>(in.gcount()));
  return fmt::format("{:08x}", crc);
}

bool changes_results(const OptionSpec& option) {
  for (const char* name :
       {"--threads", "--progress", "--quiet", "--json", "--force", "--output", "--resume", "--config"})
    if (option.name == name) return false;
  return !option.positional;
}

std::string run_record(const Session& session, const std::vector<fs::path>& inputs) {
  TomlWriter toml;
  toml.comment("How these results were made. The keys under [options] can be given back with --config.");
  toml.entry("program", TomlValue(fmt::format("dendrofit {}", version())));
  toml.entry("command", TomlValue(std::string(session.command())));
  toml.entry("seed", TomlValue(static_cast<std::int64_t>(session.common().seed)));
  toml.table("options");
  for (const OptionSpec& option : session.options().all()) {
    const std::string value = option.current();
    if (value.empty() || !changes_results(option)) continue;
    if (option.current_list)
      toml.entry(option.name.substr(2), TomlValue(option.current_list()));
    else
      toml.entry(option.name.substr(2), TomlValue(value));
  }
  for (const fs::path& input : inputs) {
    toml.array_table("input");
    toml.entry("file", TomlValue(input.filename().string()));
    toml.entry("bytes", TomlValue(static_cast<std::int64_t>(fs::file_size(input))));
    toml.entry("crc32", TomlValue(checksum(input)));
  }
  return toml.text();
}

}  // namespace dendrofit::cli
