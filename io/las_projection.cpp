// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las_projection.h"

#include "io/text_numbers.h"

#include <algorithm>
#include <array>

namespace dendrofit {
namespace {

enum : std::uint16_t {  // records
  kWkt = 2112,
  kKeys = 34735,
  kTexts = 34737
};
enum : std::uint16_t {  // GeoTIFF keys
  kModelType = 1024,
  kCitation = 1026,
  kGeographic = 2048,
  kGeographicCitation = 2049,
  kProjected = 3072,
  kProjectedCitation = 3073,
  kVertical = 4096
};
constexpr std::uint16_t kUserDefined = 32767;

bool is_epsg(std::int64_t code) {
  return code > 0 && code < kUserDefined;
}

// A code of the EPSG table; 0 for other words.
std::uint16_t epsg_code(std::string_view digits) {
  std::int64_t code = 0;
  return integer_from(digits, code) && is_epsg(code) ? static_cast<std::uint16_t>(code) : std::uint16_t{0};
}

// A record's content; empty where there is none.
std::string_view content_of(const std::vector<LasRecord>& records, std::uint16_t id) {
  for (const LasRecord& record : records)
    if (record.id == id && !record.content.empty()) return record.content;
  return {};
}

// What the directory of keys says; `texts` is the record its citations point into.
std::string crs_of_keys(std::string_view keys, std::string_view texts) {
  const auto at = [&](std::size_t k) { return FileBytes::load<std::uint16_t>(keys.data() + 2 * k); };
  if (keys.size() < 8) return {};
  std::uint16_t projected = 0;
  std::uint16_t geographic = 0;
  std::uint16_t vertical = 0;
  std::string name;
  const std::size_t count = std::min<std::size_t>(at(3), keys.size() / 8 - 1);
  for (std::size_t k = 1; k <= count; ++k) {
    const std::uint16_t id = at(4 * k), where = at(4 * k + 1), length = at(4 * k + 2), value = at(4 * k + 3);
    if (id == kProjected && where == 0) projected = value;
    if (id == kGeographic && where == 0) geographic = value;
    if (id == kVertical && where == 0) vertical = value;
    // Keys are in ascending order: the projected system's own name comes last.
    const bool citation = id == kCitation || id == kGeographicCitation || id == kProjectedCitation;
    if (citation && where == kTexts && value < texts.size()) {
      const std::string_view text = texts.substr(value, length);
      name = printable_text(text.substr(0, text.find('|')));
    }
  }
  const std::uint16_t code = is_epsg(projected) ? projected : geographic;
  if (!is_epsg(code)) return name;
  return "EPSG:" + std::to_string(code) + (is_epsg(vertical) ? "+" + std::to_string(vertical) : "");
}

using Key = std::array<std::uint16_t, 4>;  // id, where, count, value or place

LasRecord key_directory(const std::vector<Key>& keys) {
  std::string bytes;
  const auto append = [&](const Key& key) {
    bytes.append(reinterpret_cast<const char*>(key.data()), sizeof(key));
  };
  append({1, 1, 0, static_cast<std::uint16_t>(keys.size())});
  for (const Key& key : keys) append(key);
  return {kKeys, bytes};
}

// "EPSG:n" or "EPSG:n+m" as keys; none for other words. Codes 4000 to 4999 are geographic systems.
std::vector<Key> keys_of(std::string_view crs) {
  if (!crs.starts_with("EPSG:")) return {};
  const std::size_t plus = crs.find('+');
  const bool compound = plus != std::string_view::npos;
  const std::uint16_t code = epsg_code(crs.substr(5, compound ? plus - 5 : plus));
  const std::uint16_t vertical = compound ? epsg_code(crs.substr(plus + 1)) : std::uint16_t{0};
  if (code == 0 || (compound && vertical == 0)) return {};
  const bool geographic = code >= 4000 && code < 5000;
  std::vector<Key> keys = {{kModelType, 0, 1, static_cast<std::uint16_t>(geographic ? 2 : 1)},
                           {geographic ? kGeographic : kProjected, 0, 1, code}};
  if (compound) keys.push_back({kVertical, 0, 1, vertical});
  return keys;
}

}  // namespace

std::string printable_text(std::string_view text) {
  text = text.substr(0, text.find('\0'));
  std::string clean;
  for (const char c : text) clean += static_cast<unsigned char>(c) >= 32 && c != 127 ? c : ' ';
  while (!clean.empty() && clean.back() == ' ') clean.pop_back();
  return clean;
}

std::string crs_of(const std::vector<LasRecord>& records) {
  const std::string wkt = printable_text(content_of(records, kWkt));
  return wkt.empty() ? crs_of_keys(content_of(records, kKeys), content_of(records, kTexts)) : wkt;
}

std::vector<LasRecord> projection_of(const std::string& crs) {
  if (crs.empty()) return {};
  if (crs.find('[') != std::string::npos) return {{kWkt, crs + '\0'}};
  if (const std::vector<Key> keys = keys_of(crs); !keys.empty()) return {key_directory(keys)};
  const std::string name = crs.substr(0, 1000) + "|";
  return {key_directory({{kModelType, 0, 1, kUserDefined},
                         {kCitation, kTexts, static_cast<std::uint16_t>(name.size()), 0}}),
          {kTexts, name + '\0'}};
}

}  // namespace dendrofit
