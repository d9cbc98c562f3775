// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image_segmentation.h"

#include "core/errors.h"
#include "recon/image_distance.h"
#include "recon/image_ground.h"
#include "recon/image_pieces.h"
#include "recon/image_sky.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

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
    const int width = last - x + 1;
    const double middle = 0.5 * (x + last);
    // A stem goes on upwards: follow its middle for some widths.
    double up = middle;
    int tall = 0;
    for (int above = lift; above < sky.height && tall < 6 * width + 10; ++above, ++tall) {
      const int c = static_cast<int>(std::lround(up));
      if (c < 0 || c >= sky.width || !is_wood(c, above)) break;
      int f = c, l = c;
      while (f > 0 && l - f < 3 * width && is_wood(f - 1, above)) --f;
      while (l + 1 < sky.width && l - f < 3 * width && is_wood(l + 1, above)) ++l;
      if (l - f + 1 > 2 * width) break;
      up = 0.5 * (f + l);
    }
    double score = std::min(width, tall);
    if (root) score /= 1 + std::abs(middle - root->x()) / std::max(10.0, 0.02 * sky.width);
    if (score > best_score) {
      best_score = score;
      const int row = sky.horizon[static_cast<std::size_t>(std::lround(middle))] - lift;
      best = StemCrossing{x, last, row, tall > width ? std::clamp((middle - up) / tall, -0.3, 0.3) : 0};
    }
    x = last;
  }
  return best;
}

/// Share of a pixel that wood covers: from bark's own ratio (the median of pixels inside wood) to the sky's.
void set_cover(Silhouette& s, const SkyRatio& sky) {
  const std::vector<float> inside = distance_inside(s.tree, s.width, s.height);
  std::vector<float> bark;
  for (int x = 0; x < s.width; ++x)
    for (int y = 0; y < sky.horizon[static_cast<std::size_t>(x)]; ++y)
      if (inside[s.pixel(x, y)] >= 2.5f) bark.push_back(sky.ratio[s.pixel(x, y)]);
  float dark = 0.35f;
  if (bark.size() > 50) {
    auto middle = bark.begin() + static_cast<std::ptrdiff_t>(bark.size() / 2);
    std::nth_element(bark.begin(), middle, bark.end());
    dark = std::min(*middle, 0.75f);
  }
  s.cover.assign(s.tree.size(), 0);
  for (int y = 0; y < s.height; ++y)
    for (int x = 0; x < s.width; ++x) {
      const std::size_t p = s.pixel(x, y);
      if (y < sky.horizon[static_cast<std::size_t>(x)])
        s.cover[p] = std::clamp((1 - sky.ratio[p]) / (1 - dark), 0.0f, 1.0f);
      else
        s.cover[p] = s.tree[p];
    }
}

[[noreturn]] void no_tree(const std::string& why) {
  throw SolverError("no tree found: " + why);
}

/// Whether a group looks like a tree rather than stalks or a pole: its wood gets wider in sum above its
/// lowest tenth (a branching stem carries more width the higher, a tuft of grass less), or it has one stem
/// far thicker than what stands beside it.
bool looks_like_tree(const TreeGroup& g, const std::vector<std::int32_t>& group, std::int32_t id, int width) {
  std::vector<double> sums;
  std::vector<double> base_runs;
  const int base_top = g.bottom - g.height() / 10;
  double base = 0;
  for (int y = g.top; y <= g.bottom; ++y) {
    double sum = 0, run = 0;
    for (int x = g.left; x <= g.right + 1; ++x) {
      const bool wood = x <= g.right && group[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                              static_cast<std::size_t>(x)] == id;
      if (wood) {
        ++sum;
        ++run;
      } else if (run > 0) {
        if (y >= base_top) base_runs.push_back(run);
        run = 0;
      }
    }
    if (y >= base_top)
      base += sum / (g.bottom - base_top + 1);
    else
      sums.push_back(sum);
  }
  if (sums.empty() || base_runs.empty()) return false;
  std::sort(sums.begin(), sums.end());
  std::sort(base_runs.begin(), base_runs.end());
  const double upper = sums[sums.size() * 9 / 10];
  return upper > 1.5 * base || base_runs.back() > 5 * base_runs[base_runs.size() / 2];
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
  const std::vector<TreeGroup> groups = group_pieces(s.tree, s.width, s.height, gap, group);
  if (groups.empty() || groups.front().height() < 0.08 * photo.height) no_tree("nothing darker than the sky");
  const double sharp = edge_sharpness(sky, s.tree);
  if (sharp < 0.5) no_tree("nothing darker than the sky has an edge; clouds or haze are no tree");
  bool any = false;
  for (std::size_t g = 0; g < groups.size() && groups[g].height() > 0.4 * groups.front().height(); ++g)
    any = any || looks_like_tree(groups[g], group, static_cast<std::int32_t>(g), photo.width);
  if (!any) no_tree("only stalks or poles before the sky; give --mask if one is a tree");

  // Each tall group that stands on the horizon is followed to the ground.
  for (std::size_t g = 0; g < groups.size() && groups[g].height() > 0.4 * groups.front().height(); ++g)
    if (const auto stem = find_crossing(sky, group, static_cast<std::int32_t>(g), options.root_px))
      follow_stem_down(photo, *stem, s.tree);
  if (sky.horizon_share > 0.5 && sky.median_horizon < 0.98 * photo.height) s.horizon_px = sky.median_horizon;
  set_cover(s, sky);
  s.confidence = std::min({separability(sky), sky.border_share, steadiness(sky, options.seed_ratio),
                           static_cast<double>(groups.front().pixels) /
                               static_cast<double>(std::count(s.tree.begin(), s.tree.end(), 1))});
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
