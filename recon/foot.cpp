// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/foot.h"

#include "core/errors.h"
#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace dendrofit {
namespace {

/// A connected piece of the scan's lowest slice, with a line x = a + b z through it.
struct Piece {
  std::vector<std::uint32_t> points;
  double low = 0, high = 0;  // heights
  Eigen::Vector2d middle{0, 0}, slope{0, 0};
  double middle_z = 0;
  double diameter = 0;
};

Piece describe(std::vector<std::uint32_t> members, const std::vector<Vec3>& points,
               const std::vector<double>& height) {
  Piece piece;
  piece.points = std::move(members);
  const auto n = static_cast<double>(piece.points.size());
  piece.low = 1e300;
  piece.high = -1e300;
  Vec3 mean = Vec3::Zero();
  for (const std::uint32_t i : piece.points) {
    mean += points[i] / n;
    piece.low = std::min(piece.low, height[i]);
    piece.high = std::max(piece.high, height[i]);
  }
  double zz = 0;
  Eigen::Vector2d xz(0, 0);
  for (const std::uint32_t i : piece.points) {
    const Vec3 d = points[i] - mean;
    zz += d.z() * d.z();
    xz += d.z() * d.head<2>();
  }
  if (zz > 0) piece.slope = xz / zz;
  // A ring of radius R has a mean square distance R^2 from its middle.
  double spread = 0;
  for (const std::uint32_t i : piece.points) {
    const Vec3 d = points[i] - mean;
    spread += (d.head<2>() - piece.slope * d.z()).squaredNorm() / n;
  }
  piece.middle = mean.head<2>();
  piece.middle_z = mean.z();
  piece.diameter = 2 * std::sqrt(spread);
  return piece;
}

std::vector<Piece> pieces_between(const std::vector<Vec3>& points, const PointGraph& graph,
                                  const std::vector<double>& height, double low, double high) {
  std::vector<Piece> pieces;
  std::vector<char> open(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) open[i] = height[i] >= low && height[i] < high;
  std::vector<std::uint32_t> members;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!open[i]) continue;
    members.assign(1, static_cast<std::uint32_t>(i));
    open[i] = 0;
    for (std::size_t m = 0; m < members.size(); ++m)
      for (const std::uint32_t v : graph.of(members[m]))
        if (open[v]) {
          open[v] = 0;
          members.push_back(v);
        }
    if (members.size() >= 6) pieces.push_back(describe(members, points, height));
  }
  return pieces;
}

/// Whether a piece is wood seen from outside: thin, or hollow (points on a closed surface), at half of its
/// levels at least. Foliage fills its cross-section.
bool looks_like_wood(const Piece& piece, const std::vector<Vec3>& points, const PointGraph& graph,
                     const std::vector<double>& height, double thin) {
  constexpr int kLevels = 4;
  constexpr double kHollow = 0.2;  // scatter about the circle over its radius; a filled disc has 0.35
  if (piece.diameter <= thin) return true;
  std::vector<std::vector<std::uint32_t>> level(kLevels);
  for (const std::uint32_t i : piece.points) {
    const double share = (height[i] - piece.low) / (piece.high - piece.low);
    level[static_cast<std::size_t>(std::clamp(static_cast<int>(share * kLevels), 0, kLevels - 1))].push_back(
        i);
  }
  std::vector<char> open(points.size(), 0);
  std::vector<std::uint32_t> members;
  std::vector<Eigen::Vector2d> flat;
  int good = 0;
  for (const auto& all : level) {
    bool found = false;
    std::size_t most = 0;
    for (const std::uint32_t i : all) open[i] = 1;
    for (const std::uint32_t seed : all) {
      if (!open[seed]) continue;
      members.assign(1, seed);
      open[seed] = 0;
      for (std::size_t m = 0; m < members.size(); ++m)
        for (const std::uint32_t v : graph.of(members[m]))
          if (open[v]) {
            open[v] = 0;
            members.push_back(v);
          }
      if (members.size() < 6) continue;
      const Piece part = describe(members, points, height);
      flat.clear();
      for (const std::uint32_t i : members)
        flat.push_back(points[i].head<2>() - part.middle - part.slope * (points[i].z() - part.middle_z));
      const CircleFit fit = algebraic_circle(flat);
      if (members.size() <= most) continue;  // the level's largest cluster speaks for it
      most = members.size();
      found =
          part.diameter <= thin || (fit.ok && fit.rms < kHollow * fit.radius && fit.radius < piece.diameter);
    }
    good += found;
  }
  return 2 * good >= kLevels;
}

Foot foot_of(const Piece& piece, const std::vector<Vec3>& points, const PointGraph& graph,
             const std::vector<double>& height, const Ground& ground, double lowest) {
  Foot foot;
  foot.slope = piece.slope;
  foot.diameter_m = piece.diameter;
  const double reach = 0.85 * piece.diameter + 2 * graph.typical_spacing_m;
  const auto axis_at = [&](double z) -> Eigen::Vector2d {
    return piece.middle + piece.slope * (z - piece.middle_z);
  };
  double ring = std::max(3 * graph.typical_spacing_m, 0.25 * piece.diameter);
  for (int attempt = 0; attempt < 6 && foot.points.size() < 8; ++attempt, ring *= 1.6) {
    foot.points.clear();
    for (std::uint32_t i = 0; i < points.size(); ++i)
      if (height[i] < lowest + ring && (points[i].head<2>() - axis_at(points[i].z())).norm() <= reach)
        foot.points.push_back(i);
  }
  double z = 1e300;
  for (const std::uint32_t i : foot.points) z = std::min(z, points[i].z());
  if (ground.present) {
    const Eigen::Vector2d at = axis_at(z);
    z = ground.height_at(at.x(), at.y());
  }
  const Eigen::Vector2d at = axis_at(z);
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
  if (points.size() < 20)
    throw SolverError("too few points for a tree: " + std::to_string(points.size()) +
                      " are left after cleaning, at least 20 are needed; give the whole tree, in metres");
  double top = 0, lowest = 1e300;
  lowest = 0;  // strays below do not count
  for (const double h : height) top = std::max(top, h);
  const double thickest = kThickestStem * top + 0.1;
  double widest_seen = 0;
  std::size_t upright = 0, filled = 0;
  for (const double share : {0.12, 0.2, 0.07}) {
    const double slice = std::clamp(share * (top - lowest), 0.15, 1.6);
    std::vector<Piece> pieces = pieces_between(points, graph, height, lowest, lowest + slice);
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
      Foot foot = foot_of(*stem, points, graph, height, ground, lowest);
      if (!foot.points.empty()) feet.push_back(std::move(foot));
    }
    if (!feet.empty()) return feet;
  }
  std::ostringstream why;
  why.precision(2);
  why << "no stem found: in the lowest " << std::fixed << std::clamp(0.12 * (top - lowest), 0.15, 1.6)
      << " m of this " << top << " m tall scan ";
  if (upright == 0)
    why << "nothing stands upright (loose clusters up to " << widest_seen << " m across)";
  else if (filled > 0)
    why << "points fill the space as foliage does, none lie on a trunk's surface";
  else
    why << "the wood is spread over " << widest_seen << " m, a stem would be under " << thickest
        << " m thick";
  why << "; is the stem occluded or cut off? Scan the lower trunk too, or keep it when clipping the tree";
  throw SolverError(why.str());
}

std::size_t close_low_vegetation(const std::vector<Vec3>& points, const PointGraph& graph,
                                 const std::vector<double>& height, const Ground& ground,
                                 const std::vector<Foot>& feet, std::vector<char>& open) {
  if (!ground.present) return 0;
  double top = 0;
  for (const double h : height) top = std::max(top, h);
  const double grass = std::min(0.5, 0.08 * top), shrubs = std::min(1.5, 0.2 * top);
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
