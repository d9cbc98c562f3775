// SPDX-License-Identifier: GPL-3.0-or-later
// TOML files as flat lists of dotted keys, and the writing of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace dendrofit {

/// A value: a scalar or an array of scalars of one kind (an array of numbers with any fraction is all
/// double).
using TomlValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::int64_t>,
                               std::vector<double>, std::vector<std::string>, std::vector<bool>>;

/// One `key = value`. Tables give dotted keys ("site.latitude"); the entries of an array of tables are
/// numbered from 0
/// ("tree.0.root", "tree.1.root").
struct TomlEntry {
  std::string key;
  TomlValue value;
  int line = 0;  ///< in the file, from 1
};

/// All entries in the order of their lines. Throws IoError "file, line N: ..." for what is not TOML, for a
/// nested or mixed array, a date, or a number that is not finite.
std::vector<TomlEntry> read_toml(const std::filesystem::path& path);
/// The same where a table without keys says nothing and is a mistake: IoError "file, line N: [name] ...".
std::vector<TomlEntry> read_toml_without_empty_tables(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages.
std::vector<TomlEntry> parse_toml(std::string_view text, const std::string& name);

/// The entry's value as a number (whole numbers too), text, truth value or list of numbers; `where` is the
/// file's name. Throws InputError "where, line N: key: expected a number, found ...".
double toml_number(const TomlEntry& entry, const std::string& where);
std::string toml_text(const TomlEntry& entry, const std::string& where);
bool toml_truth(const TomlEntry& entry, const std::string& where);
std::vector<double> toml_numbers(const TomlEntry& entry, const std::string& where);

/// Builds a file line by line. Numbers are printed with as many digits as reading them back needs.
class TomlWriter {
 public:
  TomlWriter& comment(std::string_view text);      ///< each line after "# "
  TomlWriter& table(std::string_view name);        ///< [name]
  TomlWriter& array_table(std::string_view name);  ///< [[name]]
  TomlWriter& entry(std::string_view key, const TomlValue& value, std::string_view remark = "");
  TomlWriter& entry(std::string_view key, const char* text) {
    return entry(key, TomlValue(std::string(text)));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace dendrofit
