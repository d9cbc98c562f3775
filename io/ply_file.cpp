// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ply_file.h"

#include "io/text_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace dendrofit {
namespace {

constexpr std::array<std::size_t, 8> kWidth = {1, 1, 2, 2, 4, 4, 4, 8};

std::optional<PlyType> type_named(std::string_view word) {
  constexpr std::array<std::array<std::string_view, 2>, 8> names = {{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
  for (std::size_t k = 0; k < names.size(); ++k)
    if (word == names[k][0] || word == names[k][1]) return static_cast<PlyType>(k);
  return std::nullopt;
}

}  // namespace

std::size_t ply_width(PlyType type) {
  return kWidth[static_cast<std::size_t>(type)];
}

double ply_number(PlyType type, const char* from, std::endian order) {
  switch (type) {
    case PlyType::int8:
      return static_cast<std::int8_t>(*from);
    case PlyType::uint8:
      return static_cast<std::uint8_t>(*from);
    case PlyType::int16:
      return FileBytes::load<std::int16_t>(from, order);
    case PlyType::uint16:
      return FileBytes::load<std::uint16_t>(from, order);
    case PlyType::int32:
      return FileBytes::load<std::int32_t>(from, order);
    case PlyType::uint32:
      return FileBytes::load<std::uint32_t>(from, order);
    case PlyType::float32:
      return static_cast<double>(FileBytes::load<float>(from, order));
    case PlyType::float64:
      return FileBytes::load<double>(from, order);
  }
  return 0;
}

int PlyElement::find(std::string_view property) const {
  for (std::size_t k = 0; k < properties.size(); ++k)
    if (!properties[k].is_list && properties[k].name == property) return static_cast<int>(k);
  return -1;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::stride() const {
  std::size_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += ply_width(p.is_list ? p.count_type : p.type);
  return bytes;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  for (const PlyElement& e : elements)
    if (e.name == element) return &e;
  return nullptr;
}

PlyHeader read_ply_header(const FileBytes& bytes) {
  const std::string_view view = bytes.view();
  PlyHeader header;
  bool has_format = false;
  std::size_t at = 0;
  while (true) {
    const std::size_t end = view.find('\n', at);
    ++header.lines;
    const auto fail = [&](const std::string& what) { fail_at_line(bytes.path(), header.lines, what); };
    if (end == std::string_view::npos || end - at > 1 << 17)
      fail("the header has no 'end_header'; the file is truncated or no PLY");
    const std::string_view line = trimmed(view.substr(at, end - at));
    const std::vector<std::string_view> words = words_of(line);
    at = end + 1;
    if (header.lines == 1) {
      if (words.size() != 1 || words[0] != "ply") fail("'ply' expected on the first line");
      continue;
    }
    constexpr std::string_view crs = "comment crs ";
    if (line.starts_with(crs)) header.crs = trimmed(line.substr(crs.size()));
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() == 3) {
      has_format = true;
      header.ascii = words[1] == "ascii";
      header.order = words[1] == "binary_big_endian" ? std::endian::big : std::endian::little;
      if (!header.ascii && words[1] != "binary_little_endian" && words[1] != "binary_big_endian")
        fail("format " + shown(words[1]) + "; expected ascii, binary_little_endian or binary_big_endian");
    } else if (words[0] == "element" && words.size() == 3) {
      std::int64_t count = 0;
      if (!integer_from(words[2], count) || count < 0)
        fail("element count " + shown(words[2]) + "; a whole number expected");
      header.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(count), {}});
    } else if (words[0] == "property" && !header.elements.empty() &&
               (words.size() == 3 || (words.size() == 5 && words[1] == "list"))) {
      PlyProperty property;
      property.is_list = words.size() == 5;
      property.name = words.back();
      const auto type = type_named(words[words.size() - 2]);
      const auto count_type = property.is_list ? type_named(words[2]) : PlyType::uint8;
      if (!type || !count_type) fail("property type " + shown(words[1]) + " is not known");
      property.type = *type;
      property.count_type = *count_type;
      header.elements.back().properties.push_back(std::move(property));
    } else {
      fail(shown(words[0]) + " found; expected format, element, property, comment or end_header");
    }
  }
  if (!has_format) fail_at_line(bytes.path(), header.lines, "no 'format' line in the header");
  header.data_offset = at;
  std::uint64_t least = 0;  // bytes the elements take at the very least
  for (const PlyElement& e : header.elements) {
    if (e.properties.empty() && e.count > 0)
      fail_at_line(bytes.path(), header.lines, "element '" + e.name + "' has no properties");
    const std::uint64_t each = header.ascii ? 2 * e.properties.size() : e.stride();
    // An ascii file may lack its last line's end.
    if (each > 0 &&
        e.count > (view.size() - at + 1 - std::min<std::uint64_t>(least, view.size() - at)) / each)
      fail_at_byte(bytes.path(), view.size(),
                   "the header claims " + std::to_string(e.count) + " of '" + e.name +
                       "', the file ends before; it is truncated");
    least += each * e.count;
  }
  return header;
}

void PlyCursor::fail(const std::string& what) const {
  if (header_.ascii) fail_at_line(bytes_.path(), line_, what);
  fail_at_byte(bytes_.path(), at_, what);
}

double PlyCursor::next(PlyType type) {
  if (!header_.ascii) {
    const std::size_t width = ply_width(type);
    if (width > bytes_.size() - at_)
      fail("the file ends before the numbers its header claims; it is truncated");
    const double value = ply_number(type, bytes_.data() + at_, header_.order);
    at_ += width;
    return value;
  }
  const std::string_view view = bytes_.view();
  while (at_ < view.size() &&
         (view[at_] == ' ' || view[at_] == '\t' || view[at_] == '\r' || view[at_] == '\n'))
    if (view[at_++] == '\n') ++line_;
  if (at_ >= view.size()) fail("the file ends before the numbers its header claims; it is truncated");
  double value = 0;
  const char* end = view.data() + view.size();
  const char* stop = parse_number(view.data() + at_, end, value);
  if (!stop || (stop != end && *stop != ' ' && *stop != '\t' && *stop != '\r' && *stop != '\n')) {
    const std::string_view word = view.substr(at_, view.find_first_of(" \t\r\n", at_) - at_);
    fail(shown(word) + " found, a number expected" +
         (word.find(',') != std::string_view::npos ? " (PLY has no decimal comma)" : ""));
  }
  at_ = static_cast<std::uint64_t>(stop - view.data());
  return value;
}

std::uint64_t PlyCursor::next_count(PlyType type) {
  const double count = next(type);
  if (!(count >= 0) || count != std::floor(count)) fail("a list of length " + std::to_string(count));
  if (count > static_cast<double>(bytes_.size() - at_))
    fail("a list longer than the rest of the file; it is damaged");
  return static_cast<std::uint64_t>(count);
}

void PlyCursor::skip(const PlyElement& element) {
  for (const PlyProperty& p : element.properties) {
    const std::uint64_t n = p.is_list ? next_count(p.count_type) : 1;
    for (std::uint64_t k = 0; k < n; ++k) next(p.type);
  }
}

}  // namespace dendrofit
