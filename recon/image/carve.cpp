// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/carve.h"

#include "core/errors.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <Eigen/LU>

namespace dendrofit {
namespace {

constexpr double kHalfDiagonal = 0.8660254037844386;
constexpr double kSkin = 1.1;  // cells: how deep below the surface a cell still belongs to the skin
constexpr std::size_t kBlock = 2048;

/// A cell of the octree at some level: integer position of its lower corner in cells of that level.
struct Cell {
  std::int32_t x, y, z;
};

struct Verdict {
  bool keep = false;
  bool deep = false;  // wholly inside, away from the surface
  std::uint64_t misses = 0;
  double depth_m = 0;  // of the centre above (negative: below) the hull's surface
};

/// How much longer than at the picture's middle a short line's picture is at a pixel, at most.
double picture_stretch(const Camera& camera, const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.fx, y = (pixel.y() - camera.cy) / camera.fy;
  const double r2 = x * x + y * y;
  return (1 + r2) * (1.02 + 3 * std::abs(camera.k1) * r2 + 5 * std::abs(camera.k2) * r2 * r2);
}

/// What the views say of a ball of radius `ball_m` about `centre`; 0: of the point alone, which may lie
/// `slack_m` beside the masks.
Verdict judge(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines, const Vec3& centre,
              double ball_m, double slack_m, const CarveOptions& options) {
  Verdict verdict;
  int seen = 0, hidden = 0, missed = 0;
  double shallowest = -1e300;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const double depth = cameras[i].depth(centre);
    if (ball_m > 0 && depth <= ball_m + 1e-6)
      continue;  // the ball reaches the camera's plane: nothing is said yet
    const auto pixel = cameras[i].project(centre);
    if (pixel && outlines[i].unknown(*pixel)) {
      ++hidden;
      continue;
    }
    if (!pixel) {
      if (++missed > options.misses_allowed) return verdict;
      if (i < 64) verdict.misses |= std::uint64_t{1} << i;
      continue;
    }
    ++seen;
    const double scale = cameras[i].fx / depth;
    const double ball_px =
        ball_m > 0 ? ball_m * picture_stretch(cameras[i], *pixel) * cameras[i].fx / (depth - ball_m) : 0;
    const double outside = outlines[i].at(*pixel) - options.tolerance_px - slack_m * scale;
    if (outside > ball_px) {
      if (++missed > options.misses_allowed) return verdict;
      if (i < 64) verdict.misses |= std::uint64_t{1} << i;
    } else {
      shallowest = std::max(shallowest, outside / scale);
    }
  }
  if (ball_m > 0) {
    verdict.keep = true;
    verdict.deep = missed == 0 && seen == static_cast<int>(cameras.size()) &&
                   shallowest < -(1.25 * ball_m + 4 * kSkin * options.cell_m);
  } else {
    verdict.keep = seen - missed >= 2 && seen >= hidden;
    verdict.depth_m = shallowest;
  }
  return verdict;
}

Cell child_of(const Cell& cell, int k) {
  return {2 * cell.x + (k & 1), 2 * cell.y + (k >> 1 & 1), 2 * cell.z + (k >> 2)};
}

/// The children that `keeps` keeps, in order.
std::vector<Cell> split(const std::vector<Cell>& cells, const std::function<bool(const Cell&)>& keeps,
                        int threads, Progress& progress) {
  std::vector<std::vector<Cell>> kept((cells.size() + kBlock - 1) / kBlock);
  parallel_blocks(cells.size(), kBlock, threads, [&](std::size_t first, std::size_t end) {
    progress.check();
    for (std::size_t c = first; c < end; ++c)
      for (int k = 0; k < 8; ++k)
        if (const Cell child = child_of(cells[c], k); keeps(child)) kept[first / kBlock].push_back(child);
  });
  std::vector<Cell> all;
  for (const auto& block : kept) all.insert(all.end(), block.begin(), block.end());
  return all;
}

/// The skin among the cells' children (`children` = 8) or the cells themselves (1).
Hull skin_of(const std::vector<Cell>& cells, int children, const std::function<Vec3(const Cell&)>& centre_of,
             double cell_m, const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
             const CarveOptions& options, Progress& progress) {
  // Cells much larger than asked for would lose wood between their centres.
  const double slack_m = 0.5 * std::max(0.0, cell_m - 2 * options.cell_m);
  std::vector<Hull> found((cells.size() + kBlock - 1) / kBlock);
  parallel_blocks(cells.size(), kBlock, options.threads, [&](std::size_t first, std::size_t end) {
    progress.check();
    Hull& skin = found[first / kBlock];
    for (std::size_t c = first; c < end; ++c)
      for (int k = 0; k < children; ++k) {
        const Vec3 centre = centre_of(children == 1 ? cells[c] : child_of(cells[c], k));
        const Verdict verdict = judge(cameras, outlines, centre, 0, slack_m, options);
        if (!verdict.keep || verdict.depth_m <= -kSkin * cell_m) continue;
        skin.cells.push_back(centre);
        skin.misses.push_back(verdict.misses);
      }
  });
  Hull hull;
  hull.cell_m = cell_m;
  for (const Hull& block : found) {
    hull.cells.insert(hull.cells.end(), block.cells.begin(), block.cells.end());
    hull.misses.insert(hull.misses.end(), block.misses.begin(), block.misses.end());
  }
  return hull;
}

void check(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines) {
  require(cameras.size() >= 2, "views", static_cast<double>(cameras.size()), "carving needs two or more");
  require(cameras.size() == outlines.size(), "outlines", static_cast<double>(outlines.size()),
          "must be as many as cameras");
  for (std::size_t i = 0; i < outlines.size(); ++i)
    if (outlines[i].area_px() == 0)
      throw InputError("view " + std::to_string(i) + ": its mask is empty; no tree to carve");
}

}  // namespace

void CarveOptions::validate() const {
  require(std::isfinite(cell_m) && cell_m >= 1e-4 && cell_m <= 1, "cell_m", cell_m,
          "must lie between 0.1 mm and 1 m");
  require(std::isfinite(tolerance_px) && tolerance_px >= 0 && tolerance_px <= 100, "tolerance_px",
          tolerance_px, "must lie between 0 and 100 pixels");
  require(most_coarse_cells >= most_cells, "most_coarse_cells", static_cast<double>(most_coarse_cells),
          "must not be below most_cells");
  require(misses_allowed >= 0, "misses_allowed", misses_allowed, "must not be negative");
}

Vec3 common_middle(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines) {
  // Least squares over the distances from the rays.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Vec3 ray = cameras[i].ray(outlines[i].middle());
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose();
    normal += across;
    right += across * cameras[i].centre();
  }
  if (normal.determinant() < 1e-9)
    throw SolverError(
        "the views look the same way: their rays do not meet, so nothing can be carved; take "
        "photographs from around the tree");
  return normal.inverse() * right;
}

double carving_cell_m(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines) {
  const Vec3 middle = common_middle(cameras, outlines);
  std::vector<double> footprint;
  for (const Camera& camera : cameras)
    if (camera.depth(middle) > 0) footprint.push_back(camera.depth(middle) / camera.fx);
  if (footprint.size() < 2)
    throw SolverError(
        "the views do not look at one place: their masks' middles have no point in common in front of "
        "them; check the poses (camera_from_world or world_from_camera, axes x right, y down, z forward)");
  const auto half = footprint.begin() + static_cast<std::ptrdiff_t>(footprint.size() / 2);
  std::nth_element(footprint.begin(), half, footprint.end());
  return std::max(0.003, 0.5 * *half);
}

Hull carve(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
           const CarveOptions& options, Progress& progress) {
  options.validate();
  check(cameras, outlines);
  const Vec3 middle = common_middle(cameras, outlines);
  double reach = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const double depth = cameras[i].depth(middle);
    if (depth > 0) reach = std::max(reach, 1.5 * outlines[i].reach_px() * depth / cameras[i].fx);
  }
  if (!(reach > 0))
    throw SolverError("the views' masks have no region in common in front of the cameras; check the poses");
  int levels = 0;
  while (options.cell_m * std::ldexp(1, levels) < 2 * reach) ++levels;
  const auto side_of = [&](int level) { return options.cell_m * std::ldexp(1, levels - level); };
  const Vec3 corner = middle - Vec3::Constant(0.5 * options.cell_m * std::ldexp(1, levels));

  std::vector<Cell> cells{{0, 0, 0}};
  progress.begin("carve", levels, "levels");
  int level = 0;
  const auto too_many = [&] {
    const bool fine = side_of(level) < 2.5 * options.cell_m;
    return cells.size() > (fine ? options.most_cells : options.most_coarse_cells) / 4;
  };
  while (level + 1 < levels && !too_many()) {
    ++level;
    const double side = side_of(level);
    const auto open = [&](const Cell& cell) {
      const Vec3 centre = corner + side * (Vec3(cell.x, cell.y, cell.z) + Vec3::Constant(0.5));
      const Verdict verdict = judge(cameras, outlines, centre, kHalfDiagonal * side, 0, options);
      return verdict.keep && !verdict.deep;
    };
    cells = split(cells, open, options.threads, progress);
    progress.advance(1);
  }
  // A hull too large for finer cells is kept in those it has come to.
  const bool coarse = level > 0 && too_many();
  const int last = coarse ? level : level + 1;
  const auto centre_of = [&](const Cell& cell) {
    return Vec3(corner + side_of(last) * (Vec3(cell.x, cell.y, cell.z) + Vec3::Constant(0.5)));
  };
  const Hull hull =
      skin_of(cells, coarse ? 1 : 8, centre_of, side_of(last), cameras, outlines, options, progress);
  progress.end();
  return hull;
}

std::vector<double> explained_shares(const std::vector<Vec3>& cells, double cell_m,
                                     const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                                     int threads) {
  std::vector<double> share(cameras.size(), 0);
  parallel_blocks(cameras.size(), 1, threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v) {
      const Outline& outline = outlines[v];
      const auto w = static_cast<std::size_t>(outline.width());
      std::vector<char> covered(w * static_cast<std::size_t>(outline.height()), 0);
      for (const Vec3& cell : cells) {
        const auto pixel = cameras[v].project(cell);
        if (!pixel) continue;
        const double half = std::max(0.5, kHalfDiagonal * cell_m * cameras[v].fx / cameras[v].depth(cell));
        const int x0 = std::max(0, static_cast<int>(std::floor(pixel->x() - half)));
        const int y0 = std::max(0, static_cast<int>(std::floor(pixel->y() - half)));
        const int x1 = std::min(outline.width() - 1, static_cast<int>(std::floor(pixel->x() + half)));
        const int y1 = std::min(outline.height() - 1, static_cast<int>(std::floor(pixel->y() + half)));
        for (int y = y0; y <= y1; ++y)
          for (int x = x0; x <= x1; ++x)
            covered[static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)] = 1;
      }
      std::size_t explained = 0;
      for (int y = 0; y < outline.height(); ++y)
        for (int x = 0; x < outline.width(); ++x)
          explained +=
              outline.inside(x, y) && covered[static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)];
      share[v] = static_cast<double>(explained) / static_cast<double>(outline.area_px());
    }
  });
  return share;
}

}  // namespace dendrofit
