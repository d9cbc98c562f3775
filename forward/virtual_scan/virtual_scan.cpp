// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/virtual_scan/virtual_scan.h"

#include "core/errors.h"
#include "core/parallel.h"
#include "core/random.h"
#include "forward/virtual_scan/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kGrassGaps = 0.25;  // share of rays that reach the ground through grass
constexpr std::uint64_t kPoseKey = ~std::uint64_t{0};

struct Return {
  Vec3 point;
  ScanClass what;
  std::int32_t node, leaf;
  float share, range_error;
};

// One instrument: where it truly is, where registration believes it is, and the angles worth scanning.
struct Station {
  Vec3 position;
  Vec3 shift = Vec3::Zero();  // registration error
  double turn = 0;
  double azimuth_lo = 0, azimuth_hi = 0, polar_lo = 0, polar_hi = 0;
};

// The window of angles that holds all the corners of the scene's box, a beam's width more on each side.
void aim(Station& station, const Bounds& box, double margin) {
  const Vec3 centre = 0.5 * (box.lo + box.hi);
  const double middle = std::atan2(centre.y() - station.position.y(), centre.x() - station.position.x());
  const bool inside = station.position.x() >= box.lo.x() && station.position.x() <= box.hi.x() &&
                      station.position.y() >= box.lo.y() && station.position.y() <= box.hi.y();
  double widest = 0;
  station.polar_lo = std::numbers::pi, station.polar_hi = 0;
  const Vec3 nearest = station.position.cwiseMax(box.lo).cwiseMin(box.hi);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at(corner & 1 ? box.hi.x() : box.lo.x(), corner & 2 ? box.hi.y() : box.lo.y(),
                  corner & 4 ? box.hi.z() : box.lo.z());
    const Vec3 to = at - station.position;
    widest =
        std::max(widest, std::abs(std::remainder(std::atan2(to.y(), to.x()) - middle, 2 * std::numbers::pi)));
    // The box's nearest edge sees the steepest angles.
    for (const Vec3& foot : {at, Vec3(nearest.x(), nearest.y(), at.z())}) {
      const Vec3 ray = foot - station.position;
      const double polar = std::atan2(std::hypot(ray.x(), ray.y()), ray.z());
      station.polar_lo = std::min(station.polar_lo, polar);
      station.polar_hi = std::max(station.polar_hi, polar);
    }
  }
  if (inside) widest = std::numbers::pi;
  station.azimuth_lo = middle - std::min(widest + margin, std::numbers::pi);
  station.azimuth_hi = middle + std::min(widest + margin, std::numbers::pi);
  station.polar_lo = std::max(0.0, station.polar_lo - margin);
  station.polar_hi = std::min(std::numbers::pi, station.polar_hi + margin);
}

double rise_of(const ScanOptions& options) {
  return options.ground_radius_m ? std::tan(options.ground_slope_deg * kDegree) : 0.0;
}

std::vector<Station> place_stations(const Tree& tree, const ScanOptions& options, const Vec3& foot) {
  std::vector<Vec3> positions = options.positions;
  if (positions.empty())
    for (int s = 0; s < options.stations; ++s) {
      const double azimuth =
          options.first_azimuth_deg * kDegree + 2 * std::numbers::pi * s / options.stations;
      const double east = options.distance_m * std::cos(azimuth);
      positions.push_back(foot + Vec3(east, options.distance_m * std::sin(azimuth),
                                      rise_of(options) * east + options.instrument_height_m));
    }
  Bounds box;
  for (std::size_t i = 0; i < tree.size(); ++i)
    for (const Vec3& end : {tree.start[i], tree.end[i]}) {
      box.add(end - Vec3::Constant(tree.radius[i]));
      box.add(end + Vec3::Constant(tree.radius[i]));
    }
  if (options.ground_radius_m) {
    const double radius = *options.ground_radius_m, rise = std::abs(rise_of(options)) * radius;
    box.add(foot - Vec3(radius, radius, rise));
    box.add(foot + Vec3(radius, radius, rise + options.grass_height_m));
  }
  std::vector<Station> stations;
  for (std::size_t s = 0; s < positions.size(); ++s) {
    Station station{positions[s]};
    aim(station, box, options.step_deg * kDegree);
    Random random = Random(options.seed).child({s, kPoseKey});
    for (int axis = 0; axis < 3; ++axis) station.shift[axis] = options.registration_error_m * random.normal();
    station.turn = options.registration_error_deg * kDegree * random.normal();
    stations.push_back(station);
  }
  return stations;
}

ScanClass class_of(RayHit::What what) {
  return what == RayHit::What::wood    ? ScanClass::wood
         : what == RayHit::What::leaf  ? ScanClass::leaf
         : what == RayHit::What::grass ? ScanClass::grass
                                       : ScanClass::ground;
}

// One beam: its sub-rays' hits in order of range, merged where they lie closer than the range resolution.
void fire(const RayScene& scene, const Station& station, const ScanOptions& options, double polar,
          double azimuth, Random random, std::vector<Return>& returns) {
  if (options.drop_out > 0 && random.uniform() < options.drop_out) return;
  const Vec3 beam(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
  const Vec3 side = beam.unitOrthogonal(), up = beam.cross(side);
  std::vector<RayHit> hits;
  const double spin = random.uniform(0, 2 * std::numbers::pi);
  for (int ray = 0; ray < options.rays_per_beam; ++ray) {
    // Sunflower filling of the footprint's disc, the first ray in its middle.
    const double part =
        options.rays_per_beam == 1 ? 0 : std::sqrt(static_cast<double>(ray) / (options.rays_per_beam - 1));
    const double angle = spin + ray * 2.39996322972865332;
    const Vec3 outwards = part * (std::cos(angle) * side + std::sin(angle) * up);
    const Vec3 origin = station.position + 0.5 * options.exit_diameter_m * outwards;
    const Vec3 direction = (beam + 0.5e-3 * options.divergence_mrad * outwards).normalized();
    double grass = 0;
    if (options.grass_height_m > 0 && random.uniform() >= kGrassGaps)
      grass = options.grass_height_m * random.uniform();
    const RayHit hit = scene.cast(options.rays_per_beam == 1 ? station.position : origin, direction,
                                  options.max_range_m, grass);
    if (hit.what != RayHit::What::nothing) hits.push_back(hit);
  }
  std::stable_sort(hits.begin(), hits.end(),
                   [](const RayHit& a, const RayHit& b) { return a.range_m < b.range_m; });

  int emitted = 0;
  for (std::size_t first = 0; first < hits.size() && emitted < options.max_returns; ++emitted) {
    std::size_t last = first + 1;
    while (last < hits.size() && hits[last].range_m - hits[last - 1].range_m < options.range_resolution_m)
      ++last;
    double mean = 0;
    for (std::size_t i = first; i < last; ++i) mean += hits[i].range_m;
    const auto count = static_cast<double>(last - first);
    mean /= count;
    // What the footprint saw most of; ties go to the nearer.
    std::size_t owner = first;
    std::size_t most = 0;
    for (std::size_t i = first; i < last; ++i) {
      std::size_t same = 0;
      for (std::size_t j = first; j < last; ++j)
        same += hits[j].what == hits[i].what && hits[j].id == hits[i].id;
      if (same > most) most = same, owner = i;
    }
    const double range = mean + options.range_noise_m * random.normal();
    const Vec3 measured = station.position + range * beam;
    const Vec3 turned = Eigen::AngleAxisd(station.turn, Vec3::UnitZ()) * (measured - station.position);
    Return out;
    out.point = station.position + turned + station.shift;
    out.what = class_of(hits[owner].what);
    out.node = hits[owner].what == RayHit::What::wood ? hits[owner].id : -1;
    out.leaf = hits[owner].what == RayHit::What::leaf ? hits[owner].id : -1;
    out.share = static_cast<float>(count / options.rays_per_beam);
    out.range_error = static_cast<float>(range - hits[owner].range_m);
    returns.push_back(out);
    first = last;
  }
}

}  // namespace

void ScanOptions::validate() const {
  require(positions.empty() ? stations >= 1 && stations <= 1000 : positions.size() <= 1000, "stations",
          positions.empty() ? stations : static_cast<double>(positions.size()), "must be between 1 and 1000");
  for (const Vec3& position : positions)
    if (!position.allFinite()) throw InputError("positions: a coordinate is not a finite number");
  require(distance_m > 0 && std::isfinite(distance_m), "distance_m", distance_m, "must be positive");
  require(std::isfinite(instrument_height_m), "instrument_height_m", instrument_height_m, "must be a number");
  require(step_deg >= 0.001 && step_deg <= 10, "step_deg", step_deg, "must be between 0.001 and 10 degrees");
  require(divergence_mrad >= 0 && divergence_mrad <= 100, "divergence_mrad", divergence_mrad,
          "must be between 0 and 100");
  require(exit_diameter_m >= 0 && exit_diameter_m <= 1, "exit_diameter_m", exit_diameter_m,
          "must be between 0 and 1 m");
  require(rays_per_beam >= 1 && rays_per_beam <= 1000, "rays_per_beam", rays_per_beam,
          "must be between 1 and 1000");
  require(range_resolution_m >= 0 && std::isfinite(range_resolution_m), "range_resolution_m",
          range_resolution_m, "must not be negative");
  require(max_returns >= 1, "max_returns", max_returns, "must be at least 1");
  require(range_noise_m >= 0 && range_noise_m <= 10, "range_noise_m", range_noise_m,
          "must be between 0 and 10 m");
  require(registration_error_m >= 0 && registration_error_m <= 10, "registration_error_m",
          registration_error_m, "must be between 0 and 10 m");
  require(registration_error_deg >= 0 && registration_error_deg <= 45, "registration_error_deg",
          registration_error_deg, "must be between 0 and 45");
  require(drop_out >= 0 && drop_out < 1, "drop_out", drop_out, "must be at least 0 and less than 1");
  require(max_range_m > 0 && std::isfinite(max_range_m), "max_range_m", max_range_m, "must be positive");
  require(ground_slope_deg >= -60 && ground_slope_deg <= 60, "ground_slope_deg", ground_slope_deg,
          "must be between -60 and 60 degrees");
  require(grass_height_m >= 0 && grass_height_m <= 5, "grass_height_m", grass_height_m,
          "must be between 0 and 5 m");
  require(!ground_radius_m || !positions.empty() || instrument_height_m > 0, "instrument_height_m",
          instrument_height_m, "must be positive: the instrument stands above the ground");
  require(!ground_radius_m || (*ground_radius_m > 0 && std::isfinite(*ground_radius_m)), "ground_radius_m",
          ground_radius_m.value_or(0), "must be positive");
}

VirtualScan scan_tree(const Tree& tree, const Foliage* foliage, const ScanOptions& options,
                      Progress& progress) {
  options.validate();
  tree.validate();
  if (tree.empty()) throw InputError("scan: the tree has no cylinders");
  if (foliage && foliage->size() > 0 && foliage->origin_shift != tree.origin_shift)
    throw InputError("scan: tree and foliage have different origin shifts");
  Vec3 foot = tree.start[0];
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] < 0 && tree.start[i].z() < foot.z()) foot = tree.start[i];

  std::optional<GroundDisc> ground;
  if (options.ground_radius_m) ground = {*options.ground_radius_m, rise_of(options)};
  const RayScene scene(tree, foliage, options.tapered, foot, ground);
  const std::vector<Station> stations = place_stations(tree, options, foot);
  const double step = options.step_deg * kDegree;

  VirtualScan scan;
  scan.cloud.origin_shift = tree.origin_shift;
  double rows_in_all = 0;
  for (const Station& s : stations) rows_in_all += std::floor((s.polar_hi - s.polar_lo) / step) + 1;
  progress.begin("scanning", rows_in_all, "rows");
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const Station& station = stations[s];
    scan.positions.push_back(station.position);
    const auto rows = static_cast<std::size_t>((station.polar_hi - station.polar_lo) / step) + 1;
    const auto columns = static_cast<std::size_t>((station.azimuth_hi - station.azimuth_lo) / step) + 1;
    std::vector<std::vector<Return>> by_row(rows);
    parallel_blocks(rows, 4, options.threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row) {
        progress.check();
        for (std::size_t column = 0; column < columns; ++column)
          fire(scene, station, options, station.polar_lo + static_cast<double>(row) * step,
               station.azimuth_lo + static_cast<double>(column) * step,
               Random(options.seed).child({s, row, column}), by_row[row]);
      }
      progress.advance(static_cast<double>(last - first));
    });
    for (const auto& row : by_row)
      for (const Return& r : row) {
        scan.cloud.points.push_back(r.point);
        scan.cloud.intensity.push_back(r.share);
        scan.cloud.classification.push_back(static_cast<std::uint8_t>(r.what));
        scan.node.push_back(r.node);
        scan.leaf.push_back(r.leaf);
        scan.station.push_back(static_cast<std::uint16_t>(s));
        scan.range_error_m.push_back(r.range_error);
      }
  }
  progress.end();
  return scan;
}

}  // namespace dendrofit
