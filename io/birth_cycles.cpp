// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/birth_cycles.h"

#include "core/atomic_file.h"
#include "io/csv_table.h"
#include "io/text_numbers.h"

#include <string>

namespace dendrofit {

void write_birth_cycles(const std::filesystem::path& path, const Tree& tree) {
  std::string text = "id,birth_cycle\n";
  for (std::size_t i = 0; i < tree.size(); ++i) {
    append_number(text, static_cast<std::int64_t>(i) + 1);
    text += ',';
    append_number(text, std::int64_t{tree.birth_cycle[i]});
    text += '\n';
  }
  write_file(path, text);
}

void read_birth_cycles(const std::filesystem::path& path, Tree& tree) {
  const FileBytes bytes(path);
  CsvTable table(bytes);
  const std::size_t id = table.column("id"), birth = table.column("birth_cycle");
  std::size_t i = 0;
  for (; table.next(); ++i) {
    if (i >= tree.size() || table.integer(id) != static_cast<std::int64_t>(i) + 1)
      table.fail("id " + std::string(table.text(id)) + " found; expected one row for each of the tree's " +
                 std::to_string(tree.size()) + " cylinders, in rising id");
    const std::int64_t cycle = table.integer(birth);
    if (cycle < -1 || cycle > 1'000'000) table.fail("birth_cycle must be -1 to 1000000");
    tree.birth_cycle[i] = static_cast<std::int32_t>(cycle);
  }
  if (i != tree.size())
    fail_in_file(path, std::to_string(i) + " rows found; expected one for each of the tree's " +
                           std::to_string(tree.size()) + " cylinders");
}

}  // namespace dendrofit
