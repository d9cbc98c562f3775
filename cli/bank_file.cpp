// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bank_file.h"

#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace dendrofit::cli {

namespace fs = std::filesystem;

fs::path installed_bank_path() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const fs::path folder = program.parent_path();
  for (const fs::path& root : {folder, folder.parent_path()}) {
    const fs::path file = root / "share" / "dendrofit" / "igm.bank";
    if (fs::is_regular_file(file, error)) return file;
  }
  return {};
}

std::shared_ptr<const PriorBank> installed_bank() {
  const fs::path file = installed_bank_path();
  if (file.empty()) return {};
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  return std::make_shared<const PriorBank>(decode_bank(bytes, file.string()));
}

}  // namespace dendrofit::cli
