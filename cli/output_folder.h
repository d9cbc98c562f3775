// SPDX-License-Identifier: GPL-3.0-or-later
// Where a command's results go, and what it says of how they were made.
#pragma once

#include "cli/command.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// Throws UsageError where no -o was given; commands call it before they read anything.
void need_output(const std::filesystem::path& output);

/// The folder of -o. Made when it does not exist; throws UsageError when it holds results already and --force
/// was not given, IoError when it cannot be made or is a file.
std::filesystem::path prepare_output_folder(const std::filesystem::path& folder, const CommonOptions& common);

/// The same for a single output file: its folder must exist, the file must not (without --force).
void prepare_output_file(const std::filesystem::path& file, const CommonOptions& common);

/// Whether the option can change results: not --threads, --progress, --output and the like, which records
/// leave out.
bool changes_results(const OptionSpec& option);

/// Content of run.toml: version, command, seed, every resolved option that changes results, and each input
/// with its size and CRC-32.
std::string run_record(const Session& session, const std::vector<std::filesystem::path>& inputs);

/// CRC-32 (as zip, gzip and `crc32` print it) of a file's content, eight hexadecimal digits.
std::string checksum(const std::filesystem::path& file);

}  // namespace dendrofit::cli
