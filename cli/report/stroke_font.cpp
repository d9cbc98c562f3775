// SPDX-License-Identifier: GPL-3.0-or-later
// The built-in font of image.h: strokes on a grid, smoothed where a letter is round.
#include "cli/report/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dendrofit {
namespace {

// Strokes are pairs of digits "xy" (x to the right, y up: 0 descender, 2 baseline, 6 x-height, 8 capitals),
// separated by blanks; a leading ~ rounds the stroke's corners. Printable ASCII from ' ' to '~'.
constexpr std::array<std::string_view, 95> kGlyphs = {"",
                                                      "0804 02",
                                                      "0806 2826",
                                                      "1317 3337 0444 0646",
                                                      "~4748080545420203 2921",
                                                      "0248 0818170708 3343423233",
                                                      "~4216172837360403122244",
                                                      "0806",
                                                      "~18060412",
                                                      "~08161402",
                                                      "2824 0745 4705",
                                                      "2327 0545",
                                                      "1201",
                                                      "0535",
                                                      "02",
                                                      "0248",
                                                      "~280802424828",
                                                      "071812 0222",
                                                      "~0608484502 0242",
                                                      "~0708484525 ~2545420203",
                                                      "32380444",
                                                      "480805 ~052646420203",
                                                      "~4748080242460604",
                                                      "084812",
                                                      "~250508484525 ~250502424525",
                                                      "~0302424808044446",
                                                      "02 05",
                                                      "1201 15",
                                                      "470543",
                                                      "0444 0646",
                                                      "074503",
                                                      "~070848452524 22",
                                                      "~36161434 363444 ~4448080242",
                                                      "022842 1535",
                                                      "0208 ~08484505 ~05454202",
                                                      "~474808024243",
                                                      "0208 ~08484202",
                                                      "48080242 0535",
                                                      "480802 0535",
                                                      "~474808024245 4525",
                                                      "0802 4842 0545",
                                                      "0222 0828 1218",
                                                      "3834 ~34320203",
                                                      "0802 4804 1542",
                                                      "080242",
                                                      "0208254842",
                                                      "02084248",
                                                      "~280802525828",
                                                      "0208 ~08484505",
                                                      "~280802525828 3452",
                                                      "0208 ~08484505 2542",
                                                      "~4748080545420203",
                                                      "0848 2822",
                                                      "0805 ~05024245 4548",
                                                      "082248",
                                                      "0812263248",
                                                      "0842 0248",
                                                      "082548 2522",
                                                      "08480242",
                                                      "18080212",
                                                      "0842",
                                                      "08181202",
                                                      "062846",
                                                      "0141",
                                                      "0817",
                                                      "~353606023233 3632",
                                                      "0802 ~050636320203",
                                                      "~353606023233",
                                                      "3832 ~353606023233",
                                                      "0434 ~343606023233",
                                                      "~281816 1612 0626",
                                                      "~353606023233 3631 ~31300001",
                                                      "0802 ~04063634 3432",
                                                      "0602 08",
                                                      "1611 ~111000 18",
                                                      "0802 3604 1532",
                                                      "0802",
                                                      "0602 ~04062624 2422 ~24264644 4442",
                                                      "0602 ~04063634 3432",
                                                      "~160602323616",
                                                      "0600 ~050636320203",
                                                      "3630 ~353606023233",
                                                      "0602 ~040626",
                                                      "~3536060434320203",
                                                      "1813 ~131222 0626",
                                                      "0604 ~04023234 3632",
                                                      "062246",
                                                      "0612253246",
                                                      "0632 0236",
                                                      "0622 4610",
                                                      "06360232",
                                                      "28181605141222",
                                                      "0901",
                                                      "08181625141202",
                                                      "~04164446"};
constexpr std::string_view kDegree = "~180806262818";
constexpr std::string_view kPlusMinus = "2428 0646 0343";
constexpr std::string_view kUnknown = "0208383202";

// Base letters of U+00C0..U+017F.
constexpr std::string_view kBaseLetters =
    "AAAAAAACEEEEIIIIDNOOOOOxOUUUUYTsaaaaaaaceeeeiiiidnooooo/ouuuuyty"
    "AaAaAaCcCcCcCcDdDdEeEeEeEeEeGgGgGgGgHhHhIiIiIiIiIiIiJjKkkLlLlLlLlLlNnNnNnnNnOoOoOoOoRrRrRrSsSsSsSsTtTtTt"
    "UuUuUuUuUuUu"
    "WwYyYZzZzZzs";
static_assert(kBaseLetters.size() == 64 + 128);

std::vector<char32_t> code_points(std::string_view utf8) {
  std::vector<char32_t> codes;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const std::size_t length = lead < 0x80 ? 1 : lead < 0xc0 ? 0 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    char32_t code = length < 2 ? lead : lead & (0xffu >> (length + 1));
    bool sound = length != 0 && i + length <= utf8.size();
    for (std::size_t k = 1; sound && k < length; ++k) {
      const auto next = static_cast<unsigned char>(utf8[i + k]);
      sound = (next & 0xc0) == 0x80;
      code = code << 6 | (next & 0x3fu);
    }
    codes.push_back(sound ? code : U'\xfffd');
    i += sound ? length : 1;
  }
  return codes;
}

std::string_view glyph(char32_t code) {
  if (code >= 32 && code <= 126) return kGlyphs[code - 32];
  if (code >= 0xc0 && code < 0xc0 + kBaseLetters.size())
    return kGlyphs[static_cast<std::size_t>(kBaseLetters[code - 0xc0]) - 32];
  switch (code) {
    case 0xa0:
      return kGlyphs[0];
    case 0xb0:
      return kDegree;
    case 0xb1:
      return kPlusMinus;
    case 0xb2:
      return kGlyphs['2' - 32];
    case 0xb3:
      return kGlyphs['3' - 32];
    case 0xb5:
      return kGlyphs['u' - 32];
    case 0xb7:
      return kGlyphs['.' - 32];
    case 0x2013:
    case 0x2212:
      return kGlyphs['-' - 32];
    case 0x2019:
      return kGlyphs['\'' - 32];
    default:
      return kUnknown;
  }
}

using Stroke = std::vector<std::pair<double, double>>;

Stroke rounded(Stroke stroke) {
  for (int round = 0; round < 3 && stroke.size() > 2; ++round) {
    Stroke finer = {stroke.front()};
    for (std::size_t k = 0; k + 1 < stroke.size(); ++k) {
      const auto [ax, ay] = stroke[k];
      const auto [bx, by] = stroke[k + 1];
      if (k > 0) finer.emplace_back(0.75 * ax + 0.25 * bx, 0.75 * ay + 0.25 * by);
      if (k + 2 < stroke.size()) finer.emplace_back(0.25 * ax + 0.75 * bx, 0.25 * ay + 0.75 * by);
    }
    finer.push_back(stroke.back());
    stroke = std::move(finer);
  }
  return stroke;
}

std::vector<Stroke> strokes_of(std::string_view text) {
  std::vector<Stroke> strokes;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const bool round = word.front() == '~';
    if (round) word.remove_prefix(1);
    Stroke stroke;
    for (std::size_t k = 0; k + 1 < word.size(); k += 2)
      stroke.emplace_back(word[k] - '0', word[k + 1] - '0' - 2);
    strokes.push_back(round ? rounded(std::move(stroke)) : stroke);
  }
  return strokes;
}

constexpr double kUnits = 6;  // baseline to capital top
constexpr double kGap = 1.9;  // between letters

/// Every pixel once, by its distance to the nearest stroke, so that crossings and joints are no darker than
/// the rest.
void draw_glyph(Image& image, double x, double y, const std::vector<Stroke>& strokes, double unit,
                double width, Rgb colour) {
  const int reach = static_cast<int>(std::ceil(9 * unit + width));
  for (int py = static_cast<int>(y) - reach; py <= static_cast<int>(y) + reach; ++py)
    for (int px = static_cast<int>(x) - 2; px <= static_cast<int>(x) + reach; ++px) {
      double coverage = 0;
      for (const Stroke& stroke : strokes)
        for (std::size_t k = 0; k < std::max<std::size_t>(stroke.size() - 1, 1); ++k) {
          const auto [ax, ay] = stroke[k];
          const auto [bx, by] = stroke[std::min(k + 1, stroke.size() - 1)];
          const double dx = (bx - ax) * unit;
          const double dy = (ay - by) * unit;
          const double qx = px + 0.5 - x - ax * unit;
          const double qy = py + 0.5 - y + ay * unit;
          const double length2 = dx * dx + dy * dy;
          const double t = length2 > 0 ? std::clamp((qx * dx + qy * dy) / length2, 0.0, 1.0) : 0.0;
          const double half = 0.5 * (stroke.size() == 1 ? 1.5 * width : width);
          coverage = std::max(coverage, half + 0.5 - std::hypot(qx - t * dx, qy - t * dy));
        }
      image.blend(px, py, colour, coverage);
    }
}

double advance(char32_t code) {
  double width = code == U' ' || code == 0xa0 ? 1.6 : 0;
  for (const Stroke& stroke : strokes_of(glyph(code)))
    for (const auto& [x, y] : stroke) width = std::max(width, x);
  return width + kGap;
}

}  // namespace

double text_width(std::string_view utf8, double size_px) {
  double width = 0;
  for (char32_t code : code_points(utf8)) width += advance(code);
  return std::max(0.0, width - kGap) * size_px / kUnits;
}

std::string fit_text(std::string_view utf8, double size_px, double width_px) {
  if (text_width(utf8, size_px) <= width_px) return std::string(utf8);
  while (!utf8.empty()) {
    do utf8.remove_suffix(1);
    while (!utf8.empty() && (static_cast<unsigned char>(utf8.back()) & 0xc0) == 0x80);
    if (!utf8.empty() && (static_cast<unsigned char>(utf8.back()) & 0xc0) == 0xc0) utf8.remove_suffix(1);
    const std::string cut = std::string(utf8) + "..";
    if (text_width(cut, size_px) <= width_px) return cut;
  }
  return "";
}

void draw_text(Image& image, double x, double y, std::string_view utf8, double size_px, Rgb colour,
               TextAnchor anchor) {
  if (anchor != TextAnchor::left) x -= text_width(utf8, size_px) * (anchor == TextAnchor::middle ? 0.5 : 1.0);
  const double unit = size_px / kUnits;
  const double width = std::max(1.0, 0.12 * size_px);
  for (char32_t code : code_points(utf8)) {
    draw_glyph(image, x, y, strokes_of(glyph(code)), unit, width, colour);
    x += advance(code) * unit;
  }
}

}  // namespace dendrofit
