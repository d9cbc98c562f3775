// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/boughs.h"

#include "recon/image/bough_gaps.h"
#include "recon/image/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace dendrofit {
namespace {

using Colour = Eigen::Vector3f;

constexpr float kDeep = 2;       // pixels inside wood: its own colour
constexpr float kHueApart = 10;  // grey levels: bark and surroundings must differ by
constexpr float kScatter = 4;    // of the surroundings' own spread that a pixel must be off
constexpr float kLeastOff = 7;   // grey levels
constexpr float kEdge = 1.5;     // pixels about what is surely bark
constexpr float kFringe = 4;     // pixels beyond known wood that a bough must reach
constexpr int kGridStep = 12;    // columns between places where the surroundings are told
constexpr float kSure = 1.5;     // times nearer to the bark's hue than to the surroundings'
constexpr std::uint8_t kOther = 0, kFaint = 1, kMaybe = 2, kBark = 3;
constexpr float kFaintShare = 0.5F;     // of what a pixel must be off, where it leads from bough to bough
constexpr int kGapShare = 150;          // of the picture's height: a gap so led over, at most
constexpr int kCrest = 2;               // rows about the horizon
constexpr std::size_t kFewest = 8;      // of these
constexpr float kBesideCrown = 0.2F;    // of the tree's width so far: boughs reach no farther to the side
constexpr float kForkWidths = 3;        // half widths of the stem below: a fork's, at most
constexpr std::size_t kLeastBark = 50;  // pixels that tell its colour

float middle_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Colour colour_of(const Photograph& photo, std::size_t pixel) {
  return {static_cast<float>(photo.rgb[3 * pixel]), static_cast<float>(photo.rgb[3 * pixel + 1]),
          static_cast<float>(photo.rgb[3 * pixel + 2])};
}

/// Distance from the shades of a colour, dark ones and light ones.
float off_shades(const Colour& c, const Colour& of) {
  const float shade = std::clamp(c.dot(of) / std::max(1.0F, of.squaredNorm()), 0.3F, 1.3F);
  return (c - shade * of).norm();
}

/// Median colour of the darker third of the wood before the sky, away from its edges: where least of the
/// sky's light mixes in. None where there is too little.
std::optional<Colour> bark_of(const Photograph& photo, const SkyRatio& sky,
                              const std::vector<float>& inside) {
  std::vector<std::pair<float, std::size_t>> wood;  // ratio to the sky's light, pixel
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x)
      if (const std::size_t p = photo.pixel(x, y);
          inside[p] >= kDeep && y + kCrest < sky.horizon[static_cast<std::size_t>(x)])
        wood.emplace_back(sky.ratio[p], p);
  if (wood.size() < kLeastBark) return std::nullopt;
  const auto third = wood.begin() + static_cast<std::ptrdiff_t>(wood.size() / 3);
  std::nth_element(wood.begin(), third, wood.end());
  std::array<std::vector<float>, 3> channels;
  for (auto w = wood.begin(); w != third; ++w) {
    const Colour c = colour_of(photo, w->second);
    for (std::size_t k = 0; k < 3; ++k) channels[k].push_back(c[static_cast<Eigen::Index>(k)]);
  }
  return Colour(middle_of(channels[0]), middle_of(channels[1]), middle_of(channels[2]));
}

/// Half the width of the stem that bears what crosses the horizon: its cross-section is that of all it bears.
float bearing_half_width(const SkyRatio& sky, const std::vector<std::uint8_t>& tree) {
  float most = 0;
  for (int k = 1; k <= 4; ++k) {  // the line of the horizon is jagged: at some distance above it
    const int above = k * std::max(2, sky.height / 200);
    float squares = 0;
    int run = 0;
    for (int x = 0; x <= sky.width; ++x) {
      const int y = x < sky.width ? sky.horizon[static_cast<std::size_t>(x)] - above : -1;
      if (y >= 0 && tree[static_cast<std::size_t>(y) * static_cast<std::size_t>(sky.width) +
                         static_cast<std::size_t>(x)]) {
        ++run;
        continue;
      }
      squares += 0.25F * static_cast<float>(run * run);
      run = 0;
    }
    most = std::max(most, squares);
  }
  return std::sqrt(most);
}

struct Behind {
  Colour colour = Colour::Zero();
  float limit = -1;  ///< how far off it a pixel must be; negative: nothing is known
};

/// The photograph evened over 3 x 3 pixels (weights 1 2 1): grain is no hue.
class Evened {
 public:
  explicit Evened(const Photograph& photo) : photo_(photo) {}
  Colour at(int x, int y) const {
    Colour sum = Colour::Zero();
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        sum += static_cast<float>((2 - std::abs(dx)) * (2 - std::abs(dy))) *
               colour_of(photo_, photo_.pixel(std::clamp(x + dx, 0, photo_.width - 1),
                                              std::clamp(y + dy, 0, photo_.height - 1)));
    return sum / 16;
  }

 private:
  const Photograph& photo_;
};

/// What a row (its colours in `row`) shows within `reach` to either side of places `kGridStep` apart, `other`
/// columns (wood and sky) left out.
std::vector<Behind> behind_row(const std::vector<Colour>& row, const std::vector<std::uint8_t>& other,
                               int reach, const Colour& bark) {
  const int width = static_cast<int>(row.size()), step = std::max(3, reach / 20);
  std::vector<Behind> result;
  std::vector<Colour> samples;
  std::vector<float> values;
  for (int x = 0; x < width; x += kGridStep) {
    samples.clear();
    for (int c = std::max(0, x - reach); c <= std::min(width - 1, x + reach); c += step)
      if (!other[static_cast<std::size_t>(c)]) samples.push_back(row[static_cast<std::size_t>(c)]);
    Behind here;
    if (samples.size() >= kFewest) {
      for (Eigen::Index k = 0; k < 3; ++k) {
        values.clear();
        for (const Colour& c : samples) values.push_back(c[k]);
        here.colour[k] = middle_of(values);
      }
      values.clear();
      for (const Colour& c : samples) values.push_back(off_shades(c, here.colour));
      const float scatter = middle_of(values);
      if (off_shades(bark, here.colour) >= kHueApart) here.limit = std::max(kLeastOff, kScatter * scatter);
    }
    result.push_back(here);
  }
  return result;
}

/// Pixels below the horizon: of the bark's hue (kBark), rather of that than of their surroundings' (kMaybe),
/// somewhat so (kFaint).
std::vector<std::uint8_t> bark_hued(const Photograph& photo, const SkyRatio& sky,
                                    const std::vector<std::uint8_t>& tree, const Colour& bark) {
  std::vector<std::uint8_t> hued(tree.size(), 0), other(static_cast<std::size_t>(photo.width));
  std::vector<Colour> row(other.size());
  const Evened evened(photo);
  const int top = *std::min_element(sky.horizon.begin(), sky.horizon.end());
  std::vector<Behind> behind;
  for (int y = photo.height - 1; y >= std::max(0, top - kCrest); --y) {
    for (int x = 0; x < photo.width; ++x) {
      row[static_cast<std::size_t>(x)] = evened.at(x, y);
      other[static_cast<std::size_t>(x)] =
          tree[photo.pixel(x, y)] || y <= sky.horizon[static_cast<std::size_t>(x)] + 2 * kCrest;
    }
    // Against the wide surroundings first, then, what that shows left out, against the near ones; where a
    // row shows none (a crest among boughs), against those of the row below.
    for (const int reach : {photo.width / 4, std::max(24, photo.width / 33)}) {
      std::vector<Behind> here = behind_row(row, other, reach, bark);
      for (std::size_t k = 0; k < behind.size(); ++k)
        if (here[k].limit < 0) here[k] = behind[k];
      behind = std::move(here);
      for (int x = 0; x < photo.width; ++x) {
        const auto column = static_cast<std::size_t>(x);
        const Behind& b = behind[column / kGridStep];
        const int below = y - sky.horizon[column];
        const Colour& c = row[column];
        const float off = off_shades(c, b.colour);
        // Along the horizon the surroundings mix with the sky to any hue, but to lighter colours.
        // Along a crest, sky and what is below it scatter widely.
        const float limit =
            below > 8 * kCrest ? b.limit : std::min(b.limit, 0.6F * off_shades(bark, b.colour));
        const float own = off_shades(c, bark);
        const bool is = below >= -kCrest && limit >= 0 && off >= limit && off >= own &&
                        (below > kCrest || c.sum() <= 1.15F * std::max(bark.sum(), b.colour.sum()));
        const bool faint =
            below >= -kCrest && limit >= 0 && off >= kFaintShare * limit && off >= kFaintShare * own;
        hued[photo.pixel(x, y)] = static_cast<std::uint8_t>(!is                  ? (faint ? kFaint : kOther)
                                                            : off >= kSure * own ? kBark
                                                                                 : kMaybe);
        other[column] = other[column] || is;
      }
    }
  }
  return hued;
}

/// Marks what surely has the bark's hue, with its edges.
std::vector<std::uint8_t> sure_of(const std::vector<std::uint8_t>& hued, int width, int height) {
  std::vector<std::uint8_t> sure(hued.size());
  for (std::size_t p = 0; p < hued.size(); ++p) sure[p] = hued[p] == kBark;
  const std::vector<float> beyond = distance_outside(sure, width, height);
  for (std::size_t p = 0; p < hued.size(); ++p) sure[p] = hued[p] >= kMaybe && beyond[p] <= kEdge;
  return sure;
}

/// First and last column with a pixel of the tree.
std::pair<int, int> columns_of(const std::vector<std::uint8_t>& tree, int width, int height) {
  int least = width, most = -1;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (tree[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]) {
        least = std::min(least, x);
        most = std::max(most, x);
      }
  return {least, most};
}

/// The pieces of `hued` that touch known wood and reach beyond its fringe, none of them thicker than `most`
/// or far beside the crown (a wood's edge, a hedge).
std::size_t add_touching(const std::vector<std::uint8_t>& hued, int width, int height, float most,
                         std::vector<std::uint8_t>& tree) {
  std::vector<std::uint8_t> own(tree.size(), 0), seen(tree.size(), 0);
  for (std::size_t p = 0; p < tree.size(); ++p) own[p] = hued[p] && !tree[p];
  const std::vector<float> thick = distance_inside(own, width, height);
  const std::vector<float> beyond = distance_outside(tree, width, height);
  const auto [least_x, most_x] = columns_of(tree, width, height);
  const int margin = static_cast<int>(kBesideCrown * static_cast<float>(most_x - least_x));
  std::size_t added = 0;
  std::vector<std::size_t> piece;
  for (std::size_t start = 0; start < own.size(); ++start) {
    if (!own[start] || seen[start]) continue;
    piece.assign(1, start);
    seen[start] = 1;
    float reach = 0, thickest = 0, nearest = 1e9F;
    bool beside = false;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const auto w = static_cast<std::size_t>(width);
      const int x = static_cast<int>(piece[k] % w), y = static_cast<int>(piece[k] / w);
      beside = beside || x < least_x - margin || x > most_x + margin;
      reach = std::max(reach, beyond[piece[k]]);
      nearest = std::min(nearest, beyond[piece[k]]);
      thickest = std::max(thickest, thick[piece[k]]);
      for (int ny = std::max(0, y - 1); ny <= std::min(height - 1, y + 1); ++ny)
        for (int nx = std::max(0, x - 1); nx <= std::min(width - 1, x + 1); ++nx) {
          const std::size_t q = static_cast<std::size_t>(ny) * w + static_cast<std::size_t>(nx);
          if (!own[q] || seen[q]) continue;
          seen[q] = 1;
          piece.push_back(q);
        }
    }
    if (nearest > 3 || reach < kFringe || thickest > most || beside) continue;
    for (const std::size_t p : piece) tree[p] = 1;
    added += piece.size();
  }
  return added;
}

}  // namespace

std::size_t grow_boughs(const Photograph& photo, const SkyRatio& sky, std::vector<std::uint8_t>& tree) {
  const std::vector<float> inside = distance_inside(tree, photo.width, photo.height);
  const std::optional<Colour> bark = bark_of(photo, sky, inside);
  if (!bark) return 0;
  // Where boughs part they are one piece, wider than the stem below.
  const float most = std::max(1.5F * *std::max_element(inside.begin(), inside.end()),
                              kForkWidths * bearing_half_width(sky, tree));
  const std::vector<std::uint8_t> hued = bark_hued(photo, sky, tree, *bark);
  const std::vector<std::uint8_t> sure = sure_of(hued, photo.width, photo.height);
  // Pieces that touch only what was just added are reached by a second look.
  std::size_t added = 0;
  for (int round = 0; round < 4; ++round) {
    const std::size_t now =
        add_touching(sure, photo.width, photo.height, most, tree) +
        bridge_gaps(sure, hued, photo.width, photo.height, std::max(6, photo.height / kGapShare), tree);
    added += now;
    if (now == 0) break;
  }
  return added;
}

}  // namespace dendrofit
