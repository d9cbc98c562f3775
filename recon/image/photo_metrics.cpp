// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/photo_metrics.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace dendrofit {
namespace {

Interval about(double value, double relative_sd) {
  return {value, value * std::max(0.0, 1 - 1.96 * relative_sd), value * (1 + 1.96 * relative_sd)};
}

/// Pixels on the silhouette may be wrong by this much either side where no mask was given.
double edge_error_px(const Silhouette& s) {
  return s.from_mask ? 0.5 : 0.75;
}

/// Root mean square distance of the top fifth's pixels from the foot's column.
double spread_of_top(const Silhouette& s, const OutlinePixels& o) {
  double sum = 0, count = 0;
  const int end = static_cast<int>(o.top.y() + 0.2 * (o.foot.y() - o.top.y()));
  for (int y = static_cast<int>(o.top.y()); y < end; ++y)
    for (int x = 0; x < s.width; ++x)
      if (s.tree[s.pixel(x, y)]) {
        sum += std::pow(x + 0.5 - o.foot.x(), 2);
        ++count;
      }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

OutlinePixels trace_outline(const Silhouette& s) {
  OutlinePixels o;
  int first_row = -1, last_row = -1;
  o.left = s.width;
  for (int y = 0; y < s.height; ++y) {
    int first = -1, last = -1;
    for (int x = 0; x < s.width; ++x) {
      if (!s.tree[s.pixel(x, y)]) continue;
      if (first < 0) first = x;
      last = x;
      o.area += s.cover[s.pixel(x, y)];
    }
    if (first < 0) continue;
    if (first < o.left) o.left = first, o.left_row = y + 0.5;
    if (last + 1 > o.right) o.right = last + 1, o.right_row = y + 0.5;
    if (first_row < 0) {
      first_row = y;
      o.top = {0.5 * (first + last + 1), y};
    }
    last_row = y;
    o.foot = {0.5 * (first + last + 1), y + 1.0};
    o.foot_width = last + 1 - first;
  }
  if (last_row <= first_row) throw SolverError("no tree found: the silhouette is empty");
  o.top_spread = spread_of_top(s, o);
  return o;
}

OutlineMetrics measure_outline(const Silhouette& s, const OutlinePixels& o, const PlaneSkeleton& skeleton,
                               const PictureFrame& frame) {
  OutlineMetrics m;
  m.height = frame.height_to(o.top);
  const Vec3 right = frame.away.cross(Vec3::UnitZ());
  const auto l = frame.point({o.left, o.left_row}), r = frame.point({o.right, o.right_row});
  if (l && r) m.width = (*r - *l).dot(right);
  // Each row's pixels at the scale of that row.
  for (int y = 0; y < s.height; ++y) {
    double cover = 0;
    for (int x = 0; x < s.width; ++x)
      if (s.tree[s.pixel(x, y)]) cover += s.cover[s.pixel(x, y)];
    if (cover <= 0) continue;
    const auto p = frame.point({o.foot.x(), y + 0.5});
    if (!p) continue;
    const double scale = frame.metres_per_pixel(*p);
    m.area += cover * scale * scale;
  }
  if (skeleton.size() > 1) {
    // The thickest way up from the foot: the lean of its lower half.
    std::vector<std::int32_t> next(skeleton.size(), -1);
    for (std::size_t i = 1; i < skeleton.size(); ++i) {
      std::int32_t& n = next[static_cast<std::size_t>(skeleton.parent[i])];
      if (n < 0 || skeleton.radius_px[i] > skeleton.radius_px[static_cast<std::size_t>(n)])
        n = static_cast<std::int32_t>(i);
    }
    std::size_t at = 0;
    const double middle = 0.5 * (o.top.y() + skeleton.px[0].y());
    while (next[at] >= 0 && skeleton.px[at].y() > middle) at = static_cast<std::size_t>(next[at]);
    const auto p = frame.point(skeleton.px[at]);
    if (p && p->z() > frame.foot.z())
      m.lean_deg = std::atan2((*p - frame.foot).dot(right), p->z() - frame.foot.z()) * 180 / std::numbers::pi;
  }
  return m;
}

TreeMetrics photo_metrics(const Tree& tree, const OutlineMetrics& outline, const PictureFrame& frame,
                          const Silhouette& silhouette, double dbh_height_m, bool metric) {
  TreeMetrics m = measure(tree, MetricsOptions{.dbh_height_m = dbh_height_m});
  m.height_m = outline.height;
  m.crown_diameter_m = outline.width;
  if (!metric) m.dbh_m.reset();
  const bool given = frame.scale_source == "height";
  // A given height fixes the top's distance from the foot; what is open then is the scale at the stem.
  m.intervals["height_m"] =
      about(m.height_m, given ? frame.scale_error : std::hypot(frame.scale_error, frame.top_lead_error));
  const double tilt = frame.known_camera || silhouette.horizon_px ? 0 : 0.03;
  const double scale = std::hypot(frame.scale_error, given ? frame.top_lead_error : 0, tilt);
  if (m.dbh_m) {
    const double pixels = *m.dbh_m / frame.metres_per_pixel(frame.foot);
    const double relative = std::hypot(1.4 * edge_error_px(silhouette) / std::max(1.0, pixels), scale);
    m.intervals["dbh_m"] = about(*m.dbh_m, relative);
    m.intervals["stem_volume_m3"] = about(m.stem_volume_m3, std::hypot(2 * relative, 0.1));
  } else {
    m.intervals["stem_volume_m3"] = about(m.stem_volume_m3, 0.25);
  }
  m.intervals["total_volume_m3"] = about(m.total_volume_m3, 0.4);
  return m;
}

void tell_scale(const PictureFrame& frame, const Silhouette& silhouette, const OutlineMetrics& outline,
                std::vector<std::string>& warnings) {
  if (frame.scale_source == "none") warnings.push_back("no scale: lengths in tree heights");
  if (frame.scale_source == "eye height")
    warnings.push_back(
        "scale from the camera's height above the foot, taken as eye height: the height is good to about 20 "
        "%; give --height or --scale-bar for better");
  if (!frame.known_camera && frame.scale_source != "none" && !silhouette.horizon_px)
    warnings.push_back("no horizon found: the camera is taken to be held upright");
  const double heights = frame.distance_m / std::max(1e-9, outline.height);
  if (heights < 1.6) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "taken from %.1f tree heights away: a top that leans to or from the camera changes the scale by "
        "about %.0f %%; two heights away are better",
        heights, 100 * frame.top_lead_error);
    warnings.push_back(text);
  }
}

void tell_skeleton(const PlaneSkeleton& skeleton, std::vector<std::string>& warnings) {
  if (skeleton.dropped_share > 0.1) {
    char text[160];
    std::snprintf(
        text, sizeof text,
        "%.0f %% of the silhouette hang on nothing and are left out: the mask is broken, or twigs are "
        "too thin for this picture",
        100 * skeleton.dropped_share);
    warnings.push_back(text);
  }
  warnings.push_back(
      "Depth is invented: azimuths, lengths and volume are guesses; diameters and angles in the picture are "
      "measured.");
}

}  // namespace dendrofit
