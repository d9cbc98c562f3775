// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/foot.h"

#include "core/errors.h"
#include "recon/cylinder_fit.h"
#include "recon/pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace dendrofit {
namespace {

/// The axis and thickness of a stem seen from one side only: its points' mean lies on its surface and their
/// scatter is less than its girth's; a circle through the arc tells both. Seen all round, the mean does.
void complete_arc(Piece& piece, const std::vector<Vec3>& points, double spacing_m) {
  constexpr double kAllRound = 0.75, kArc = 0.25;  // shares of the girth
  constexpr double kScatter = 0.12;                // about the circle, over its radius
  constexpr double kThickest = 2;                  // times what a closed ring would be
  std::vector<Eigen::Vector2d> flat;
  for (const std::uint32_t p : piece.points) flat.push_back(points[p].head<2>() - piece.at(points[p].z()));
  const CircleFit start = algebraic_circle(flat);
  if (!start.ok || start.radius > kThickest * piece.diameter) return;
  const CircleFit fit = robust_circle(flat, start, std::max(0.25 * spacing_m, 0.03 * start.radius));
  if (!fit.ok || fit.coverage < kArc || fit.coverage >= kAllRound || fit.rms > kScatter * fit.radius ||
      2 * fit.radius > kThickest * piece.diameter || 4 * fit.inliers < 3 * flat.size())
    return;
  piece.middle += fit.centre;
  piece.diameter = 2 * fit.radius;
}

Foot foot_of(Piece piece, const std::vector<Vec3>& points, const PointGraph& graph,
             const std::vector<double>& height, const Ground& ground) {
  complete_arc(piece, points, graph.typical_spacing_m);
  Foot foot;
  foot.slope = piece.slope;
  foot.diameter_m = piece.diameter;
  const double reach = 0.85 * piece.diameter + 2 * graph.typical_spacing_m;
  double ring = std::max(3 * graph.typical_spacing_m, 0.25 * piece.diameter);
  for (int attempt = 0; attempt < 6 && foot.points.size() < 8; ++attempt, ring *= 1.6) {
    foot.points.clear();
    for (std::uint32_t i = 0; i < points.size(); ++i)
      if (height[i] < ring && (points[i].head<2>() - piece.at(points[i].z())).norm() <= reach)
        foot.points.push_back(i);
  }
  double z = 1e300;
  for (const std::uint32_t i : foot.points) z = std::min(z, points[i].z());
  if (ground.present) {
    const Eigen::Vector2d at = piece.at(z);
    z = ground.height_at(at.x(), at.y());
  }
  const Eigen::Vector2d at = piece.at(z);
  foot.position = {at.x(), at.y(), z};
  return foot;
}

}  // namespace

std::vector<double> heights_above_foot(const std::vector<Vec3>& points, const Parts& parts,
                                       const Ground& ground) {
  constexpr std::uint32_t kWorthTheName = 10;
  std::vector<double> height(points.size());
  double lowest = 1e300;
  if (!ground.present) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (parts.points[parts.part[i]] >= kWorthTheName) lowest = std::min(lowest, points[i].z());
    if (lowest == 1e300) lowest = 0;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    height[i] = points[i].z() - (ground.present ? ground.height_at(points[i].x(), points[i].y()) : lowest);
  return height;
}

std::vector<Foot> find_feet(const std::vector<Vec3>& points, const PointGraph& graph,
                            const std::vector<double>& height, const Ground& ground) {
  constexpr double kThickestStem = 0.14;  // diameter over height of the stoutest stems, with a margin
  constexpr double kThinShare = 0.025;  // thinner wood (share of the height) need not show that it is hollow
  constexpr double kSpan = 0.6;         // share of the slice's height that a stem must cover
  constexpr double kSteepest = 1.0;     // sideways a metre of height: a stem may lean 45 degrees
  constexpr double kHighestGrass = 0.15;  // of the tree's height
  if (points.size() < 20)
    throw SolverError("too few points for a tree: " + std::to_string(points.size()) +
                      " are left after cleaning, at least 20 are needed; give the whole tree, in metres");
  double top = 0;
  for (const double h : height) top = std::max(top, h);
  const double thickest = kThickestStem * top + 0.1;
  double widest_seen = 0;
  std::size_t upright = 0, filled = 0;
  // Grass and herbs tie all that stands in them into one piece: over ground, stems are looked for above them
  // too.
  std::vector<std::array<double, 2>> slices = {
      {0, 0.12}, {0, 0.2}, {0, 0.07}};  // begin in m, share of height
  if (ground.present)
    for (const double begin : {0.15, 0.3, 0.5, 0.75})
      if (begin < kHighestGrass * top) slices.push_back({begin, 0.12});
  for (const auto& [begin, share] : slices) {
    const double slice = std::clamp(share * top, 0.15, 1.6);
    std::vector<Piece> pieces = pieces_between(points, graph, height, begin, begin + slice);
    std::vector<const Piece*> stems;
    for (const Piece& piece : pieces) {
      widest_seen = std::max(widest_seen, piece.diameter);
      if (piece.high - piece.low < kSpan * slice) continue;
      ++upright;
      if (piece.diameter > thickest || piece.slope.norm() > kSteepest) continue;
      if (!looks_like_wood(piece, points, graph, height,
                           std::max(kThinShare * top, 3 * graph.typical_spacing_m))) {
        ++filled;
        continue;
      }
      stems.push_back(&piece);
    }
    if (stems.empty()) continue;
    const auto support = [](const Piece* p) {
      return p->diameter * (p->high - p->low) * std::sqrt(static_cast<double>(p->points.size()));
    };
    std::stable_sort(stems.begin(), stems.end(),
                     [&](const Piece* a, const Piece* b) { return support(a) > support(b); });
    std::vector<Foot> feet;
    for (const Piece* stem : stems) {
      Foot foot = foot_of(*stem, points, graph, height, ground);
      if (!foot.points.empty()) feet.push_back(std::move(foot));
    }
    if (!feet.empty()) return feet;
  }
  std::ostringstream why;
  why.precision(2);
  why << "no stem found: in the lowest " << std::fixed << std::clamp(0.12 * top, 0.15, 1.6) << " m of this "
      << top << " m tall scan ";
  if (upright == 0)
    why << "nothing stands upright (loose clusters up to " << widest_seen << " m across)";
  else if (filled > 0)
    why << "points fill the space as foliage does, none lie on a trunk's surface";
  else
    why << "the wood is spread over " << widest_seen << " m, a stem would be under " << thickest
        << " m thick";
  why << "; is the stem occluded or cut off? Scan the lower trunk too, or keep it when clipping the tree. Of "
         "a "
         "plot with undergrowth, clip one tree";
  throw SolverError(why.str());
}

void keep_points(CleanScan& scan, const std::vector<char>& keep, std::vector<Foot>& feet) {
  std::vector<std::uint32_t> number(scan.points.size(), Paths::kNone);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (!keep[i]) continue;
    number[i] = static_cast<std::uint32_t>(kept);
    scan.points[kept] = scan.points[i];
    scan.source[kept++] = scan.source[i];
  }
  scan.points.resize(kept);
  scan.source.resize(kept);
  for (Foot& foot : feet) {
    for (std::uint32_t& p : foot.points) p = number[p];
    std::erase(foot.points, Paths::kNone);
  }
}

std::size_t close_low_vegetation(const std::vector<Vec3>& points, const PointGraph& graph,
                                 const std::vector<double>& height, const Ground& ground,
                                 const std::vector<Foot>& feet, std::vector<char>& open) {
  double top = 0;
  for (const double h : height) top = std::max(top, h);
  const double shrubs = std::min(1.5, 0.2 * top);
  // Without ground about it the tree was cut out of its scene: its boughs may hang low.
  const double grass = ground.present ? std::min(0.5, 0.08 * top) : 0;
  std::size_t closed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!open[i] || height[i] >= grass) continue;
    const bool at_stem = std::any_of(feet.begin(), feet.end(), [&](const Foot& f) {
      const Eigen::Vector2d axis = f.position.head<2>() + f.slope * (points[i].z() - f.position.z());
      return (points[i].head<2>() - axis).norm() <= 0.75 * f.diameter_m + 2 * graph.typical_spacing_m;
    });
    if (at_stem) continue;
    open[i] = 0;
    ++closed;
  }
  const Parts parts = connected_parts(graph, open);
  std::vector<char> wanted(parts.points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (open[i] && height[i] > shrubs) wanted[parts.part[i]] = 1;
  if (!ground.present) {  // what does not stand on the tree's own level hangs
    std::vector<char> on_ground(parts.points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (open[i] && height[i] <= std::min(0.15, 0.03 * top)) on_ground[parts.part[i]] = 1;
    for (std::size_t k = 0; k < wanted.size(); ++k) wanted[k] = wanted[k] || !on_ground[k];
  }
  for (const Foot& f : feet)
    for (const std::uint32_t p : f.points)
      if (open[p]) wanted[parts.part[p]] = 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!open[i] || wanted[parts.part[i]]) continue;
    open[i] = 0;
    ++closed;
  }
  return closed;
}

}  // namespace dendrofit
