// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/segmentation.h"

#include "core/errors.h"
#include "recon/image/boughs.h"
#include "recon/image/cover.h"
#include "recon/image/ground.h"
#include "recon/image/pieces.h"
#include "recon/image/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kSlender = 0.15;  ///< a stem is thinner than this share of the height above it
constexpr double kDark = 0.85;     ///< wood's luminance over the sky's is below this

Silhouette from_mask(const Photograph& photo) {
  Silhouette s;
  s.width = photo.width;
  s.height = photo.height;
  s.from_mask = true;
  s.tree.resize(photo.mask.size());
  for (std::size_t i = 0; i < photo.mask.size(); ++i) s.tree[i] = photo.mask[i] ? 1 : 0;
  s.cover.assign(s.tree.begin(), s.tree.end());
  return s;
}

/// Pixels above the horizon darker than `grow` that hang together with some darker than `seed`.
std::vector<std::uint8_t> hysteresis(const SkyRatio& sky, double seed, double grow) {
  std::vector<std::uint8_t> tree(sky.ratio.size(), 0);
  std::vector<std::array<int, 2>> stack;
  const auto visit = [&](int x, int y, double limit) {
    if (x < 0 || y < 0 || x >= sky.width || y >= sky.horizon[static_cast<std::size_t>(x)]) return;
    const std::size_t p =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(sky.width) + static_cast<std::size_t>(x);
    if (tree[p] || !(sky.ratio[p] < limit)) return;
    tree[p] = 1;
    stack.push_back({x, y});
  };
  for (int y = 0; y < sky.height; ++y)
    for (int x = 0; x < sky.width; ++x) {
      visit(x, y, seed);
      while (!stack.empty()) {
        const auto [px, py] = stack.back();
        stack.pop_back();
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) visit(px + dx, py + dy, grow);
      }
    }
  return tree;
}

/// 1 less the change of the dark area when the threshold moves by a tenth.
double steadiness(const SkyRatio& sky, double threshold) {
  std::array<double, 3> area{};
  for (int x = 0; x < sky.width; ++x)
    for (int y = 0; y < sky.horizon[static_cast<std::size_t>(x)]; ++y) {
      const float q = sky.ratio[static_cast<std::size_t>(y) * static_cast<std::size_t>(sky.width) +
                                static_cast<std::size_t>(x)];
      for (std::size_t k = 0; k < 3; ++k) area[k] += q < threshold * (0.9 + 0.1 * static_cast<double>(k));
    }
  return area[1] > 0 ? std::clamp(1 - (area[2] - area[0]) / (2 * area[1]), 0.0, 1.0) : 0;
}

/// Share of the outline across which the ratio jumps: wood has edges, clouds and haze fade.
double edge_sharpness(const SkyRatio& sky, const std::vector<std::uint8_t>& tree) {
  double sharp = 0, all = 0;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(sky.width) + static_cast<std::size_t>(x);
  };
  for (int y = 3; y + 3 < sky.height; ++y)
    for (int x = 3; x + 3 < sky.width; ++x) {
      if (y + 3 >= sky.horizon[static_cast<std::size_t>(x)] || !tree[at(x, y)]) continue;
      for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}}) {
        if (tree[at(x + dx, y + dy)]) continue;
        ++all;
        sharp += sky.ratio[at(x + 2 * dx, y + 2 * dy)] - sky.ratio[at(x - dx, y - dy)] > 0.08f;
      }
    }
  return all > 0 ? sharp / all : 0;
}

struct Run {
  int first, last;
};

/// The stem above a run of wood: its width (the median of the rows above, which a branch on the horizon does
/// not widen), where it would cross the run's row, and how it leans. None where nothing goes up from the run.
template <class IsWood>
std::optional<StemCrossing> follow_up(const IsWood& is_wood, int first, int last, int lift,
                                      const SkyRatio& sky) {
  struct Row {
    int above, width;
    double middle;
  };
  std::vector<Row> rows;
  int f = first, l = last, thinnest = last - first + 1;
  // No farther than three widths: above, the stem forks.
  for (int above = lift; above < sky.height && above < lift + std::max(15, 3 * thinnest); ++above) {
    // The widest run within the one below.
    int best_f = 0, best_l = -1;
    for (int c = std::max(0, f); c <= std::min(sky.width - 1, l); ++c) {
      if (!is_wood(c, above)) continue;
      int from = c, to = c;
      while (from > 0 && is_wood(from - 1, above)) --from;
      while (to + 1 < sky.width && is_wood(to + 1, above)) ++to;
      if (to - from > best_l - best_f) best_f = from, best_l = to;
      c = to;
    }
    if (best_l < best_f) break;
    f = best_f;
    l = best_l;
    thinnest = std::min(thinnest, l - f + 1);
    rows.push_back({above, l - f + 1, 0.5 * (f + l)});
  }
  if (rows.size() < 5) return std::nullopt;
  std::vector<int> widths;
  for (const Row& row : rows) widths.push_back(row.width);
  auto at = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
  std::nth_element(widths.begin(), at, widths.end());
  const int width = *at;
  // A line through the rows about as wide as that.
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Row& row : rows) {
    if (row.width > 1.4 * width + 1 || row.width < 0.6 * width) continue;
    ++n;
    sx += row.above;
    sy += row.middle;
    sxx += static_cast<double>(row.above) * row.above;
    sxy += row.above * row.middle;
  }
  if (n < 5) return std::nullopt;
  const double slope = (n * sxy - sx * sy) / std::max(1e-9, n * sxx - sx * sx);
  const double middle = (sy - slope * sx) / n + slope * lift;
  StemCrossing stem;
  stem.first = std::max(0, static_cast<int>(std::lround(middle - 0.5 * (width - 1))));
  stem.last = std::min(sky.width - 1, stem.first + width - 1);
  const int column = std::clamp(static_cast<int>(std::lround(middle)), 0, sky.width - 1);
  stem.row = sky.horizon[static_cast<std::size_t>(column)] - lift;
  stem.slope = std::clamp(-slope, -0.3, 0.3);
  return stem;
}

/// Where the group stands on the horizon: its widest run of wood just above it, with the horizon's row there.
std::optional<StemCrossing> find_crossing(const SkyRatio& sky, const std::vector<std::int32_t>& group,
                                          std::int32_t id, const std::optional<Eigen::Vector2d>& root) {
  std::optional<StemCrossing> best;
  double best_score = 0;
  const int lift = std::max(2, sky.height / 200);
  std::vector<char> column(static_cast<std::size_t>(sky.width), 0);
  const auto is_wood = [&](int x, int above) {
    const int y = sky.horizon[static_cast<std::size_t>(x)] - above;
    return y >= 0 && y < sky.height &&
           group[static_cast<std::size_t>(y) * static_cast<std::size_t>(sky.width) +
                 static_cast<std::size_t>(x)] == id;
  };
  for (int x = 0; x < sky.width; ++x) column[static_cast<std::size_t>(x)] = is_wood(x, lift);
  for (int x = 0; x < sky.width; ++x) {
    if (!column[static_cast<std::size_t>(x)]) continue;
    int last = x;
    while (last + 1 < sky.width && column[static_cast<std::size_t>(last + 1)]) ++last;
    if (const auto stem = follow_up(is_wood, x, last, lift, sky)) {
      const int width = stem->last - stem->first + 1;
      const double middle = 0.5 * (stem->first + stem->last);
      const double score =
          root ? width / (1 + std::abs(middle - root->x()) / std::max(10.0, 0.02 * sky.width)) : width;
      if (score > best_score) {
        best_score = score;
        best = stem;
      }
    }
    x = last;
  }
  return best;
}

[[noreturn]] void no_tree(const std::string& why) {
  throw SolverError("no tree found: " + why);
}

/// Drops groups that are not darker than the sky to the eye (dry grass is darker in blue alone).
void drop_bright_groups(const Photograph& photo, const SkyRatio& sky, double seed, Silhouette& s,
                        std::vector<std::int32_t>& group, std::vector<TreeGroup>& groups) {
  std::vector<std::vector<float>> light(groups.size());
  for (std::size_t p = 0; p < group.size(); ++p)
    if (group[p] >= 0 && sky.ratio[p] < seed)
      light[static_cast<std::size_t>(group[p])].push_back(
          static_cast<float>(luminance(photo, p) / sky.row_light[p / static_cast<std::size_t>(s.width)]));
  std::vector<std::int32_t> kept(groups.size(), -1);
  std::vector<TreeGroup> dark;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (light[g].empty()) continue;
    auto middle = light[g].begin() + static_cast<std::ptrdiff_t>(light[g].size() / 2);
    std::nth_element(light[g].begin(), middle, light[g].end());
    if (*middle >= kDark) continue;
    kept[g] = static_cast<std::int32_t>(dark.size());
    dark.push_back(groups[g]);
  }
  groups = std::move(dark);
  for (std::size_t p = 0; p < group.size(); ++p) {
    if (group[p] < 0) continue;
    group[p] = kept[static_cast<std::size_t>(group[p])];
    if (group[p] < 0) s.tree[p] = 0;
  }
}

std::size_t pixels_of(const std::vector<TreeGroup>& groups) {
  std::size_t sum = 0;
  for (const TreeGroup& g : groups) sum += g.pixels;
  return sum;
}

Silhouette from_sky(const Photograph& photo, const SegmentationOptions& options) {
  const std::optional<SkyRatio> found = find_sky(photo);
  if (!found) no_tree("the top of the picture is no sky to see it against; give --mask");
  const SkyRatio& sky = *found;
  Silhouette s;
  s.width = photo.width;
  s.height = photo.height;
  s.tree = hysteresis(sky, options.seed_ratio, options.grow_ratio);
  std::vector<std::int32_t> group;
  const double gap = std::max(6.0, 0.006 * photo.height);
  std::vector<TreeGroup> groups = group_pieces(s.tree, s.width, s.height, gap, group);
  const std::size_t before = pixels_of(groups);
  drop_bright_groups(photo, sky, options.seed_ratio, s, group, groups);
  if (groups.empty() || groups.front().height() < 0.08 * photo.height || 2 * pixels_of(groups) < before)
    no_tree("nothing darker than the sky");
  const double sharp = edge_sharpness(sky, s.tree);
  if (sharp < 0.5) no_tree("nothing darker than the sky has an edge; clouds or haze are no tree");
  // Each tall group that stands on the horizon is followed to the ground.
  bool followed = false;
  for (std::size_t g = 0; g < groups.size() && groups[g].height() > 0.4 * groups.front().height(); ++g) {
    const auto stem = find_crossing(sky, group, static_cast<std::int32_t>(g), options.root_px);
    if (!stem || stem->last - stem->first >= kSlender * groups[g].height()) continue;
    const int down = follow_stem_down(photo, *stem, s.tree) - stem->row;
    followed = followed || down > std::max(2 * (stem->last - stem->first), photo.height / 50);
  }
  if (grow_boughs(photo, sky, s.tree) > static_cast<std::size_t>(photo.height)) followed = true;
  if (!followed)
    s.warnings.push_back(
        "the stem is not told from what is behind it below the horizon: foot and height are uncertain; give "
        "--mask");
  s.horizon_px = clear_horizon(sky);
  set_cover(s, sky, photo);
  std::size_t standing = 0;  // on the tall groups: one tree each
  for (const TreeGroup& g : groups)
    if (g.height() > 0.4 * groups.front().height()) standing += g.pixels;
  s.confidence = std::min(
      {separability(sky), sky.border_share, steadiness(sky, options.seed_ratio),
       static_cast<double>(standing) / static_cast<double>(std::max<std::size_t>(1, pixels_of(groups)))});
  return s;
}

}  // namespace

void SegmentationOptions::validate() const {
  require(seed_ratio > 0 && seed_ratio < 1, "seed_ratio", seed_ratio, "must be between 0 and 1");
  require(grow_ratio >= seed_ratio && grow_ratio < 1, "grow_ratio", grow_ratio,
          "must be between seed_ratio and 1");
}

Silhouette find_silhouette(const Photograph& photo, const SegmentationOptions& options) {
  options.validate();
  photo.validate();
  Silhouette s = photo.mask.empty() ? from_sky(photo, options) : from_mask(photo);
  choose_tree(s, options.root_px);
  describe_silhouette(s);
  if (s.confidence < 0.5)
    s.warnings.push_back("the tree is hard to tell from what is behind it (confidence " +
                         std::to_string(std::lround(100 * s.confidence)) + " %): give --mask");
  return s;
}

}  // namespace dendrofit
