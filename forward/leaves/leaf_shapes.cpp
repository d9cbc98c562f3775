// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/leaf_shapes.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSmallestTriangle = 1e-9;  // at length 1

double radians(double degrees) {
  return degrees * kPi / 180;
}

/// A flat point (x across, y along) on the bent blade: halves raised by the fold, the midrib an arc.
Vec3 bend(double x, double y, const LeafCurvature& curvature) {
  const double fold = radians(curvature.fold_deg), droop = radians(curvature.droop_deg);
  const double across = x * std::cos(fold), up = std::abs(x) * std::sin(fold);
  if (droop < 1e-6) return {across, y, up};
  // The midrib turns evenly from level at the base to `droop` below level at the tip.
  const double turn = droop * y;
  const Vec3 on_arc(0, std::sin(turn) / droop, -(1 - std::cos(turn)) / droop);
  return on_arc + Vec3(across, up * std::sin(turn), up * std::cos(turn));
}

LeafShape scaled_to_unit_length(LeafShape shape) {
  double reach = 0;
  for (const Vec3& v : shape.vertices) reach = std::max(reach, v.y());
  if (!(reach > 0))
    throw InputError("leaf shape '" + shape.name +
                     "': no vertex lies beyond its base; +y must run to the tip");
  for (Vec3& v : shape.vertices) v /= reach;
  return shape;
}

void add(LeafShape& shape, std::size_t a, std::size_t b, std::size_t c) {
  shape.triangles.push_back(
      {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
}

/// Both halves of a blade that is mirrored about its midrib: rows of (y on the midrib, x and y of the
/// margin), from base to tip; base and tip are rows of their own, with x = 0. `midrib`: points along the
/// midrib are kept.
struct MarginPoint {
  double x;
  double y;
};

LeafShape mirrored_blade(std::string_view name, const std::vector<MarginPoint>& margin,
                         const LeafCurvature& curvature) {
  LeafShape shape;
  shape.name = name;
  const bool straight = curvature.droop_deg < 1e-6;
  const std::size_t n = margin.size();
  shape.vertices.push_back(bend(0, 0, curvature));
  shape.vertices.push_back(bend(0, 1, curvature));
  std::vector<std::size_t> rib;
  if (!straight)
    for (const MarginPoint& p : margin) {
      rib.push_back(shape.vertices.size());
      shape.vertices.push_back(bend(0, p.y, curvature));
    }
  for (const double side : {1.0, -1.0}) {
    const std::size_t first = shape.vertices.size();
    for (const MarginPoint& p : margin) shape.vertices.push_back(bend(side * p.x, p.y, curvature));
    const auto upward = [&](std::size_t a, std::size_t b, std::size_t c) {
      if (side > 0)
        add(shape, a, b, c);
      else
        add(shape, a, c, b);
    };
    if (straight) {
      // Half of a straight blade is flat: a fan from the base.
      for (std::size_t k = 0; k + 1 < n; ++k) upward(0, first + k, first + k + 1);
      upward(0, first + n - 1, 1);
      continue;
    }
    upward(0, first, rib[0]);
    for (std::size_t k = 0; k + 1 < n; ++k) {
      upward(rib[k], first + k, first + k + 1);
      upward(rib[k], first + k + 1, rib[k + 1]);
    }
    upward(rib[n - 1], first + n - 1, 1);
  }
  return scaled_to_unit_length(std::move(shape));
}

/// A leaflet: pointed, `low` the half width of its lower part, from `base` along `along`; four triangles
/// folded about its midrib.
void add_leaflet(LeafShape& shape, const Vec3& base, const Vec3& along, const Vec3& up, double length,
                 double width, double low = 0.42) {
  const Vec3 across = along.cross(up);
  const std::size_t first = shape.vertices.size();
  const auto at = [&](double x, double y) {
    shape.vertices.push_back(base + length * y * along + width * (x * across + 0.3 * std::abs(x) * up));
  };
  at(0, 0);
  at(0, 1);
  at(low, 0.25);
  at(0.45, 0.55);
  at(-low, 0.25);
  at(-0.45, 0.55);
  add(shape, first, first + 2, first + 3);
  add(shape, first, first + 3, first + 1);
  add(shape, first, first + 5, first + 4);
  add(shape, first, first + 1, first + 5);
}

/// A flat stalk from the origin to (0, length, 0).
void add_rachis(LeafShape& shape, double length, double width) {
  const std::size_t first = shape.vertices.size();
  for (const auto& [x, y] : {std::pair{-0.5, 0.0}, {0.5, 0.0}, {0.5, 1.0}, {-0.5, 1.0}})
    shape.vertices.emplace_back(x * width, y * length, 0);
  add(shape, first, first + 1, first + 2);
  add(shape, first, first + 2, first + 3);
}

void add_needle(LeafShape& shape, const Vec3& base, const Vec3& along, double length, double width) {
  const Vec3 across = along.unitOrthogonal() * (0.5 * width);
  const std::size_t first = shape.vertices.size();
  shape.vertices.push_back(base - across);
  shape.vertices.push_back(base + across);
  shape.vertices.push_back(base + length * along);
  add(shape, first, first + 1, first + 2);
}

void require_width(double width) {
  require(width > 0.001 && width <= 3, "leaf width", width, "0.001 to 3 of its length");
}

}  // namespace

void LeafCurvature::validate() const {
  require(fold_deg >= 0 && fold_deg < 80, "fold_deg", fold_deg, "0 to 80");
  require(droop_deg >= 0 && droop_deg <= 150, "droop_deg", droop_deg, "0 to 150");
}

LeafShape simple_leaf(double width, double widest, const LeafCurvature& curvature) {
  curvature.validate();
  require_width(width);
  require(widest > 0.1 && widest < 0.9, "widest", widest, "0.1 to 0.9");
  return mirrored_blade(
      "simple",
      {{0.37 * width, 0.45 * widest}, {0.5 * width, widest + 0.06}, {0.28 * width, 0.4 + 0.6 * widest}},
      curvature);
}

LeafShape lobed_leaf(double width, int lobes, const LeafCurvature& curvature) {
  curvature.validate();
  require_width(width);
  require(lobes >= 2 && lobes <= 8, "lobes", lobes, "2 to 8");
  LeafShape shape;
  shape.name = "lobed";
  // Sinus points and midrib points between lobes; each lobe a point beyond its two sinuses; widest above the
  // middle.
  const auto envelope = [&](double y) {
    return 0.5 * width * std::sin(kPi * std::pow(0.06 + 0.9 * y, 1.25));
  };
  const double step = 1.0 / (lobes + 0.5);
  for (int k = 0; k <= lobes; ++k) shape.vertices.push_back(bend(0, k * step, curvature));
  const std::size_t tip = shape.vertices.size();
  shape.vertices.push_back(bend(0, 1, curvature));
  for (const double side : {1.0, -1.0}) {
    const std::size_t first = shape.vertices.size();
    const auto upward = [&](std::size_t a, std::size_t b, std::size_t c) {
      if (side > 0)
        add(shape, a, b, c);
      else
        add(shape, a, c, b);
    };
    for (int k = 0; k <= lobes; ++k) {
      const double y = k * step;
      shape.vertices.push_back(bend(side * std::max(0.05 * width, 0.45 * envelope(y)), y + 0.02, curvature));
      const double lobe_y = (k + 0.62) * step;
      if (k < lobes) shape.vertices.push_back(bend(side * envelope(lobe_y), lobe_y + 0.03, curvature));
    }
    for (int k = 0; k < lobes; ++k) {
      const auto rib = static_cast<std::size_t>(k);
      const std::size_t sinus = first + 2 * rib;
      upward(rib, sinus, sinus + 2);
      upward(rib, sinus + 2, rib + 1);
      upward(sinus, sinus + 1, sinus + 2);
    }
    upward(static_cast<std::size_t>(lobes), first + 2 * static_cast<std::size_t>(lobes), tip);
  }
  return scaled_to_unit_length(std::move(shape));
}

LeafShape palmately_lobed_leaf(double width, int lobes, const LeafCurvature& curvature) {
  curvature.validate();
  require_width(width);
  require(lobes >= 3 && lobes <= 9 && lobes % 2 == 1, "lobes", lobes, "an odd number from 3 to 9");
  LeafShape shape;
  shape.name = "palmately lobed";
  const double spread = lobes == 3 ? 60.0 : 108.0;  // of the outermost lobes from the midrib, degrees
  const auto at = [&](double degrees, double reach) {
    shape.vertices.push_back(
        bend(width * reach * std::sin(radians(degrees)), reach * std::cos(radians(degrees)), curvature));
  };
  shape.vertices.push_back(bend(0, 0, curvature));
  const int half = (lobes - 1) / 2;
  at(spread + 25, 0.22);
  for (int k = -half; k <= half; ++k) {
    // From the right-hand outermost lobe over the tip to the left-hand one.
    const double angle = -k * spread / half;
    const double away = std::abs(static_cast<double>(k)) / half;
    at(angle, 1 - 0.5 * away * away);
    at(angle - (k == half ? 25 : 0.5 * spread / half), k == half ? 0.22 : 0.45 - 0.1 * away);
  }
  for (std::size_t k = 1; k + 1 < shape.vertices.size(); ++k) add(shape, 0, k, k + 1);
  return scaled_to_unit_length(std::move(shape));
}

LeafShape pinnate_leaf(int pairs, double leaflet_length, double leaflet_width) {
  require(pairs >= 1 && pairs <= 15, "pairs", pairs, "1 to 15");
  require_width(leaflet_length);
  require_width(leaflet_width);
  LeafShape shape;
  shape.name = "pinnate";
  const double rachis = 1 - leaflet_length * 0.9;
  add_rachis(shape, rachis, 0.012);
  const Vec3 up = Vec3::UnitZ();
  for (int k = 0; k < pairs; ++k) {
    const double y = rachis * (0.3 + 0.62 * (pairs > 1 ? static_cast<double>(k) / (pairs - 1) : 0.5));
    for (const double side : {1.0, -1.0})
      add_leaflet(shape, Vec3(side * 0.012, y, 0),
                  Vec3(side * std::sin(radians(62)), std::cos(radians(62)), 0), up,
                  leaflet_length * (0.85 + 0.15 * std::sin(kPi * (k + 1.0) / (pairs + 1))), leaflet_width);
  }
  add_leaflet(shape, Vec3(0, rachis + 0.004, 0), Vec3::UnitY(), up, leaflet_length, leaflet_width);
  return scaled_to_unit_length(std::move(shape));
}

LeafShape palmate_leaf(int leaflets, double leaflet_width) {
  require(leaflets >= 3 && leaflets <= 11, "leaflets", leaflets, "3 to 11");
  require_width(leaflet_width);
  LeafShape shape;
  shape.name = "palmate";
  const double spread = std::min(110.0, 34.0 * (leaflets - 1) / 2);
  for (int k = 0; k < leaflets; ++k) {
    const double at = 2.0 * k / (leaflets - 1) - 1;
    const double angle = radians(spread * at);
    // Outer leaflets are shorter and hang a little.
    const Vec3 along = Vec3(std::sin(angle), std::cos(angle), -0.25 * std::abs(at)).normalized();
    const Vec3 up = (Vec3::UnitZ() - along.z() * along).normalized();
    const double length = 1 - 0.45 * at * at;
    add_leaflet(shape, 0.01 * along, along, up, length, leaflet_width * length, 0.26);
  }
  return scaled_to_unit_length(std::move(shape));
}

LeafShape needle_shoot(int needles, double needle_length, double needle_width) {
  require(needles >= 3 && needles <= 500, "needles", needles, "3 to 500");
  require_width(needle_length);
  require(needle_width > 0 && needle_width < needle_length, "needle_width", needle_width,
          "above 0 and below the needle's length");
  LeafShape shape;
  shape.name = "needle shoot";
  const double lean = radians(55);
  const double axis = std::max(0.2, 1 - needle_length * std::cos(lean));
  add_rachis(shape, axis, 0.02);
  for (int k = 0; k < needles; ++k) {
    const double turn = k * kPi * (3 - std::sqrt(5.0));
    const Vec3 out(std::cos(turn), 0, std::sin(turn));
    const Vec3 along = std::sin(lean) * out + std::cos(lean) * Vec3::UnitY();
    const double off = 0.012 + needle_width;  // clear of the axis
    const Vec3 base(off * out.x(), axis * (0.06 + 0.94 * (k + 0.5) / needles), off * out.z());
    add_needle(shape, base, along, needle_length, needle_width);
  }
  return scaled_to_unit_length(std::move(shape));
}

LeafShape needle_bundle(int needles, double needle_width, double spread_deg) {
  require(needles >= 1 && needles <= 100, "needles", needles, "1 to 100");
  require(needle_width > 0 && needle_width < 0.5, "needle_width", needle_width,
          "above 0 and below 0.5 of its length");
  require(spread_deg > 0 && spread_deg < 85, "spread_deg", spread_deg, "above 0 and below 85");
  LeafShape shape;
  shape.name = "needle bundle";
  shape.petiole_width = needle_width;
  // Needles part far enough from the common point not to share their bases' width.
  const double solid = 2 * kPi * (1 - std::cos(radians(spread_deg)));
  const double base = needles == 1 ? 0 : 2.2 * needle_width / std::sqrt(solid / needles);
  for (int k = 0; k < needles; ++k) {
    // Even over the cap of the sphere about +y that the spread leaves.
    const double lean = needles == 1 ? 0 : radians(spread_deg) * std::sqrt((k + 0.5) / needles);
    const double turn = k * kPi * (3 - std::sqrt(5.0));
    const Vec3 along(std::sin(lean) * std::cos(turn), std::cos(lean), std::sin(lean) * std::sin(turn));
    add_needle(shape, base * along, along, 1, needle_width);
  }
  return scaled_to_unit_length(std::move(shape));
}

LeafShape flower(int petals) {
  require(petals >= 3 && petals <= 12, "petals", petals, "3 to 12");
  LeafShape shape;
  shape.name = "flower";
  for (int k = 0; k < petals; ++k) {
    const double turn = 2 * kPi * k / petals;
    const Vec3 along = Vec3(std::sin(turn), std::cos(turn), 0.25).normalized();
    const Vec3 across(std::cos(turn), -std::sin(turn), 0);
    const double half = 0.5 * std::sin(kPi / petals);
    const std::size_t first = shape.vertices.size();
    shape.vertices.push_back(0.08 * along);
    shape.vertices.push_back(0.7 * along + half * across);
    shape.vertices.push_back(1.0 * along);
    shape.vertices.push_back(0.7 * along - half * across);
    add(shape, first, first + 1, first + 2);
    add(shape, first, first + 2, first + 3);
  }
  // The centre: a hexagon above the petals' feet.
  const std::size_t first = shape.vertices.size();
  for (int k = 0; k < 6; ++k)
    shape.vertices.emplace_back(0.12 * std::cos(kPi * k / 3), 0.12 * std::sin(kPi * k / 3), 0.12);
  for (std::size_t k = 1; k < 5; ++k) add(shape, first, first + k, first + k + 1);
  return scaled_to_unit_length(std::move(shape));
}

LeafShape leaf_shape_from_mesh(const TriangleMesh& mesh, std::string_view name) {
  mesh.validate();
  LeafShape shape;
  shape.name = name;
  shape.vertices = mesh.vertices;
  for (Vec3& v : shape.vertices) v += mesh.origin_shift;
  shape = scaled_to_unit_length(std::move(shape));
  for (const auto& t : mesh.triangles) {
    const Vec3 a = shape.vertices[t[1]] - shape.vertices[t[0]],
               b = shape.vertices[t[2]] - shape.vertices[t[0]];
    if (0.5 * a.cross(b).norm() >= kSmallestTriangle) shape.triangles.push_back(t);
  }
  shape.validate();
  return shape;
}

}  // namespace dendrofit
