// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/toml.h"

#include "core/errors.h"
#include "io/file_bytes.h"
#include "io/json_text.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <cmath>

#include <toml++/toml.h>

namespace dendrofit {
namespace {

class Flattener {
 public:
  Flattener(const std::string& name, bool refuse_empty) : name_(name), refuse_empty_(refuse_empty) {}

  void table(const toml::table& table, const std::string& prefix) {
    for (const auto& [key, node] : table) {
      const std::string name =
          prefix.empty() ? std::string(key.str()) : prefix + "." + std::string(key.str());
      if (const auto* inner = node.as_table()) {
        check_empty(*inner, "[" + name + "]");
        this->table(*inner, name);
      } else if (const auto* list = node.as_array(); list && !list->empty() && list->get(0)->is_table()) {
        for (std::size_t i = 0; i < list->size(); ++i) {
          const auto* entry = list->get(i)->as_table();
          if (!entry) fail(*list->get(i), name, "a table expected, as the entries before it");
          check_empty(*entry, "[[" + name + "]]");
          this->table(*entry, name + "." + std::to_string(i));
        }
      } else {
        entries.push_back({name, value(node, name), static_cast<int>(node.source().begin.line)});
      }
    }
  }

  std::vector<TomlEntry> entries;

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& what) const {
    throw IoError(name_ + ", line " + std::to_string(node.source().begin.line) + ": " + key + ": " + what);
  }

  void check_empty(const toml::table& table, const std::string& title) const {
    if (refuse_empty_ && table.empty()) fail(table, title, "nothing in it; give it its keys or take it away");
  }

  double finite(const toml::node& node, const std::string& key) const {
    const double number = *node.value<double>();
    if (!std::isfinite(number)) fail(node, key, "a number that is not finite");
    return number;
  }

  TomlValue value(const toml::node& node, const std::string& key) const {
    if (node.is_boolean()) return *node.value<bool>();
    if (node.is_integer()) return *node.value<std::int64_t>();
    if (node.is_floating_point()) return finite(node, key);
    if (node.is_string()) return *node.value<std::string>();
    const auto* list = node.as_array();
    if (!list)
      fail(node, key, "dates and times mean nothing here; expected a number, text, true or false, or a list");
    const auto all = [&](auto test) { return std::all_of(list->begin(), list->end(), test); };
    if (all([](const toml::node& n) { return n.is_integer(); })) return collect<std::int64_t>(*list);
    if (all([](const toml::node& n) { return n.is_number(); })) {
      for (const toml::node& n : *list) finite(n, key);
      return collect<double>(*list);
    }
    if (all([](const toml::node& n) { return n.is_string(); })) return collect<std::string>(*list);
    if (all([](const toml::node& n) { return n.is_boolean(); })) return collect<bool>(*list);
    fail(node, key,
         "a list of several kinds, or of lists; expected all numbers, all texts, or all true and false");
  }

  template <class Value>
  static std::vector<Value> collect(const toml::array& list) {
    std::vector<Value> values;
    for (const toml::node& n : list) values.push_back(*n.value<Value>());
    return values;
  }

  const std::string& name_;
  bool refuse_empty_;
};

std::vector<TomlEntry> flatten(std::string_view text, const std::string& name, bool refuse_empty) {
  try {
    const toml::table table = toml::parse(text, name);
    Flattener flattener(name, refuse_empty);
    flattener.table(table, "");
    std::stable_sort(flattener.entries.begin(), flattener.entries.end(),
                     [](const TomlEntry& a, const TomlEntry& b) { return a.line < b.line; });
    return std::move(flattener.entries);
  } catch (const toml::parse_error& error) {
    throw IoError(name + ", line " + std::to_string(error.source().begin.line) + ": " +
                  std::string(error.description()));
  }
}

[[noreturn]] void wrong_kind(const TomlEntry& entry, const std::string& where, const char* expected) {
  constexpr const char* kinds[] = {"true or false", "a whole number", "a number", "a text",
                                   "a list",        "a list",         "a list",   "a list"};
  throw InputError(where + ", line " + std::to_string(entry.line) + ": " + entry.key + ": " +
                   kinds[entry.value.index()] + " found, " + expected + " expected");
}

void append_value(std::string& text, bool value) {
  text += value ? "true" : "false";
}
void append_value(std::string& text, std::int64_t value) {
  append_number(text, value);
}
void append_value(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
    return;
  }
  std::string number;
  append_number(number, value);
  if (number.find_first_of(".e") == std::string::npos) number += ".0";
  text += number;
}
void append_value(std::string& text, const std::string& value) {
  constexpr char digits[] = "0123456789ABCDEF";
  text += '"';
  for (const char c : valid_utf8(value)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (c == '\n') {
      text += "\\n";
    } else if (byte < 32 || byte == 127) {
      text += "\\u00";
      text += digits[byte >> 4];
      text += digits[byte & 15];
    } else {
      text += c;
    }
  }
  text += '"';
}
template <class Value>
void append_value(std::string& text, const std::vector<Value>& values) {
  text += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ", ";
    append_value(text, static_cast<Value>(values[i]));
  }
  text += ']';
}

}  // namespace

std::vector<TomlEntry> parse_toml(std::string_view text, const std::string& name) {
  return flatten(text, name, false);
}

std::vector<TomlEntry> read_toml(const std::filesystem::path& path) {
  const FileBytes bytes(path);
  return parse_toml(bytes.view(), path.string());
}

std::vector<TomlEntry> read_toml_without_empty_tables(const std::filesystem::path& path) {
  const FileBytes bytes(path);
  return flatten(bytes.view(), path.string(), true);
}

double toml_number(const TomlEntry& entry, const std::string& where) {
  if (const auto* number = std::get_if<double>(&entry.value)) return *number;
  if (const auto* whole = std::get_if<std::int64_t>(&entry.value)) return static_cast<double>(*whole);
  wrong_kind(entry, where, "a number");
}

std::string toml_text(const TomlEntry& entry, const std::string& where) {
  if (const auto* text = std::get_if<std::string>(&entry.value)) return *text;
  wrong_kind(entry, where, "a text in quotes");
}

bool toml_truth(const TomlEntry& entry, const std::string& where) {
  if (const auto* truth = std::get_if<bool>(&entry.value)) return *truth;
  wrong_kind(entry, where, "true or false");
}

std::vector<double> toml_numbers(const TomlEntry& entry, const std::string& where) {
  if (const auto* numbers = std::get_if<std::vector<double>>(&entry.value)) return *numbers;
  if (const auto* whole = std::get_if<std::vector<std::int64_t>>(&entry.value))
    return {whole->begin(), whole->end()};
  wrong_kind(entry, where, "a list of numbers");
}

TomlWriter& TomlWriter::comment(std::string_view text) {
  while (true) {
    const std::size_t end = text.find('\n');
    text_ += "# " + std::string(text.substr(0, end)) + "\n";
    if (end == std::string_view::npos) return *this;
    text.remove_prefix(end + 1);
  }
}

TomlWriter& TomlWriter::table(std::string_view name) {
  text_ += (text_.empty() ? "[" : "\n[") + std::string(name) + "]\n";
  return *this;
}

TomlWriter& TomlWriter::array_table(std::string_view name) {
  text_ += (text_.empty() ? "[[" : "\n[[") + std::string(name) + "]]\n";
  return *this;
}

TomlWriter& TomlWriter::entry(std::string_view key, const TomlValue& value, std::string_view remark) {
  text_ += std::string(key) + " = ";
  std::visit([&](const auto& v) { append_value(text_, v); }, value);
  text_ += (remark.empty() ? "" : "  # " + std::string(remark)) + "\n";
  return *this;
}

}  // namespace dendrofit
