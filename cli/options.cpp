// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/options.h"

#include "core/parameters.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

constexpr std::string_view kValueNames[] = {"NUMBER", "LENGTH", "ANGLE", "AREA", "TIME"};

template <class Integer>
Integer parse_integer(const std::string& text) {
  Integer value{};
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size())
    throw std::invalid_argument(fmt::format("'{}' is not a whole number in range", text));
  return value;
}

}  // namespace

OptionSpec& OptionTable::add(const std::string& name, const std::string& value_name,
                             const std::string& help) {
  OptionSpec spec;
  spec.name = name;
  spec.value_name = value_name;
  spec.help = help;
  options_.push_back(std::move(spec));
  return options_.back();
}

const OptionSpec* OptionTable::find(std::string_view key) const {
  const auto found = std::find_if(options_.begin(), options_.end(), [&](const OptionSpec& spec) {
    return !spec.positional && std::string_view(spec.name).substr(2) == key;
  });
  return found == options_.end() ? nullptr : &*found;
}

void OptionTable::positional(const std::string& name, std::filesystem::path& target, const std::string& help,
                             bool required) {
  OptionSpec& spec = add(name, name, help);
  spec.positional = true;
  spec.required = required;
  spec.apply = [&target](const std::string& text) { target = text; };
  spec.current = [&target] { return target.string(); };
}

void OptionTable::positionals(const std::string& name, std::vector<std::filesystem::path>& target,
                              const std::string& help, bool required) {
  OptionSpec& spec = add(name, name, help);
  spec.positional = spec.repeats = true;
  spec.required = required;
  spec.apply = [&target](const std::string& text) { target.emplace_back(text); };
  spec.current = [&target] {
    std::string all;
    for (const auto& path : target) all += (all.empty() ? "" : " ") + path.string();
    return all;
  };
}

void OptionTable::flag(const std::string& name, bool& target, const std::string& help) {
  OptionSpec& spec = add(name, "", help);
  spec.apply = [&target](const std::string& text) {
    if (text != "true" && text != "false")
      throw std::invalid_argument("'" + text + "': expected true or false");
    target = text == "true";
  };
  spec.current = [&target] { return std::string(target ? "true" : "false"); };
}

void OptionTable::text(const std::string& name, std::string& target, const std::string& value_name,
                       const std::string& help) {
  OptionSpec& spec = add(name, value_name, help);
  spec.default_text = target;
  spec.apply = [&target](const std::string& given) { target = given; };
  spec.current = [&target] { return target; };
}

void OptionTable::texts(const std::string& name, std::vector<std::string>& target,
                        const std::string& value_name, const std::string& help, bool several_at_once) {
  OptionSpec& spec = add(name, value_name, help);
  spec.repeats = true;
  spec.several_at_once = several_at_once;
  spec.current_list = [&target] { return target; };
  spec.apply = [&target](const std::string& given) { target.push_back(given); };
  spec.current = [&target] {
    std::string all;
    for (const auto& word : target) all += (all.empty() ? "" : " ") + word;
    return all;
  };
}

void OptionTable::path(const std::string& name, std::filesystem::path& target, const std::string& help,
                       const std::string& short_name) {
  OptionSpec& spec = add(name, "PATH", help);
  spec.short_name = short_name;
  spec.default_text = target.string();
  spec.apply = [&target](const std::string& given) { target = given; };
  spec.current = [&target] { return target.string(); };
}

void OptionTable::choice(const std::string& name, std::string& target,
                         const std::vector<std::string>& allowed, const std::string& help) {
  OptionSpec& spec = add(name, fmt::format("{}", fmt::join(allowed, "|")), help);
  spec.default_text = target;
  spec.apply = [&target, allowed](const std::string& given) {
    if (std::find(allowed.begin(), allowed.end(), given) == allowed.end())
      throw std::invalid_argument(fmt::format("'{}' is none of {}; did you mean '{}'?", given,
                                              fmt::join(allowed, ", "), nearest_word(given, allowed)));
    target = given;
  };
  spec.current = [&target] { return target; };
}

void OptionTable::number(const std::string& name, double& target, Quantity quantity,
                         const std::string& help) {
  OptionSpec& spec = add(name, std::string(kValueNames[static_cast<std::size_t>(quantity)]), help);
  spec.default_text = format_quantity(target, quantity);
  spec.apply = [&target, quantity](const std::string& given) { target = parse_quantity(given, quantity); };
  spec.current = [&target, quantity] { return format_quantity(target, quantity); };
}

void OptionTable::number(const std::string& name, std::optional<double>& target, Quantity quantity,
                         const std::string& help) {
  OptionSpec& spec = add(name, std::string(kValueNames[static_cast<std::size_t>(quantity)]), help);
  if (target) spec.default_text = format_quantity(*target, quantity);
  spec.apply = [&target, quantity](const std::string& given) { target = parse_quantity(given, quantity); };
  spec.current = [&target, quantity] { return target ? format_quantity(*target, quantity) : std::string(); };
}

void OptionTable::integer(const std::string& name, int& target, const std::string& help) {
  OptionSpec& spec = add(name, "N", help);
  spec.default_text = std::to_string(target);
  spec.apply = [&target](const std::string& given) { target = parse_integer<int>(given); };
  spec.current = [&target] { return std::to_string(target); };
}

void OptionTable::integer(const std::string& name, std::optional<int>& target, const std::string& help) {
  OptionSpec& spec = add(name, "N", help);
  if (target) spec.default_text = std::to_string(*target);
  spec.apply = [&target](const std::string& given) { target = parse_integer<int>(given); };
  spec.current = [&target] { return target ? std::to_string(*target) : std::string(); };
}

void OptionTable::integer(const std::string& name, std::uint64_t& target, const std::string& help) {
  OptionSpec& spec = add(name, "N", help);
  spec.default_text = std::to_string(target);
  spec.apply = [&target](const std::string& given) { target = parse_integer<std::uint64_t>(given); };
  spec.current = [&target] { return std::to_string(target); };
}

}  // namespace dendrofit::cli
