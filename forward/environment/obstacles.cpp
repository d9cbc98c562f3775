// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/obstacles.h"

#include "core/errors.h"
#include "core/point_cloud.h"
#include "forward/environment/shadows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr std::uint8_t kNoSolid = 255;
constexpr double kTouch = 1e-9;  // voxels; bodies that only touch a voxel's face leave it free

// (4q+6) 2^-q: see the header.
Fixed penumbra(int q) {
  return q > kPyramidLayers ? 0 : (Fixed{4} * q + 6) * (kFullLight >> q);
}

std::int32_t first_voxel(double cell) {
  return static_cast<std::int32_t>(std::floor(cell + 0.5 + kTouch));
}
std::int32_t last_voxel(double cell) {
  return static_cast<std::int32_t>(std::ceil(cell + 0.5 - kTouch)) - 1;
}

// Triangle against the unit cube about `centre` (separating axes; Akenine-Moeller 2001).
bool overlaps(const std::array<Vec3, 3>& corner, const Vec3& centre) {
  const double half = 0.5 - kTouch;
  std::array<Vec3, 3> v{corner[0] - centre, corner[1] - centre, corner[2] - centre};
  const auto separated = [&](const Vec3& axis) {
    const double p0 = axis.dot(v[0]), p1 = axis.dot(v[1]), p2 = axis.dot(v[2]);
    const double reach = half * axis.cwiseAbs().sum();
    return std::min({p0, p1, p2}) > reach || std::max({p0, p1, p2}) < -reach;
  };
  const std::array<Vec3, 3> edge{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 unit = Vec3::Unit(axis);
    if (separated(unit)) return false;
    for (const Vec3& e : edge)
      if (separated(unit.cross(e))) return false;
  }
  return !separated(edge[0].cross(edge[1]));
}

}  // namespace

void Solids::validate() const {
  const auto name = [](const char* kind, std::size_t i) {
    return std::string(kind) + " " + std::to_string(i + 1);
  };
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].min.allFinite() || !boxes[i].max.allFinite())
      throw InputError(name("box", i) + ": a corner is not a finite number");
    for (int axis = 0; axis < 3; ++axis)
      require(boxes[i].min[axis] < boxes[i].max[axis], name("box", i) + " min." + "xyz"[axis],
              boxes[i].min[axis], "must be less than max." + std::string(1, "xyz"[axis]));
  }
  for (std::size_t i = 0; i < half_spaces.size(); ++i) {
    if (!half_spaces[i].point.allFinite() || !half_spaces[i].normal.allFinite())
      throw InputError(name("halfspace", i) + ": point or normal is not a finite number");
    require(half_spaces[i].normal.norm() > 1e-9, name("halfspace", i) + " normal length",
            half_spaces[i].normal.norm(), "must not be zero");
  }
  for (const TriangleMesh& mesh : meshes) mesh.validate();
}

Obstacles::Obstacles(const Solids& solids, const VoxelFrame& frame, const Vec3& site_shift) : frame_(frame) {
  solids.validate();
  for (const SolidBox& box : solids.boxes) {
    const Vec3 lo = (box.min - frame.origin) / frame.edge_m, hi = (box.max - frame.origin) / frame.edge_m;
    boxes_.push_back({{first_voxel(lo.x()), first_voxel(lo.y()), first_voxel(lo.z())},
                      {last_voxel(hi.x()), last_voxel(hi.y()), last_voxel(hi.z())}});
  }
  for (const SolidHalfSpace& body : solids.half_spaces) {
    const Vec3 normal = body.normal.normalized();
    half_spaces_.push_back({normal, normal.dot((body.point - frame.origin) / frame.edge_m),
                            0.5 * normal.cwiseAbs().sum() - kTouch});
  }
  for (const TriangleMesh& mesh : solids.meshes)
    if (!mesh.triangles.empty()) meshes_.push_back(voxelise(mesh, frame, site_shift));
}

std::size_t Obstacles::VoxelMesh::index(const Voxel& v) const {
  return (static_cast<std::size_t>(v.z - lo.z) * static_cast<std::size_t>(ny) +
          static_cast<std::size_t>(v.y - lo.y)) *
             static_cast<std::size_t>(nx) +
         static_cast<std::size_t>(v.x - lo.x);
}

bool Obstacles::VoxelMesh::holds(const Voxel& v) const {
  return v.x >= lo.x && v.y >= lo.y && v.z >= lo.z && v.x < lo.x + nx && v.y < lo.y + ny && v.z < lo.z + nz;
}

Obstacles::VoxelMesh Obstacles::voxelise(const TriangleMesh& mesh, const VoxelFrame& frame,
                                         const Vec3& site_shift) {
  const auto cell = [&](std::uint32_t vertex) -> Vec3 {
    return (mesh.vertices[vertex] + (mesh.origin_shift - site_shift) - frame.origin) / frame.edge_m;
  };
  Bounds bounds;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) bounds.add(cell(vertex));
  // Room for the penumbra on every side and below, and a free shell above for the flood from outside.
  const int pad = kPyramidLayers + 1;
  const Vec3 size = bounds.size() + Vec3(2 * pad + 2, 2 * pad + 2, pad + 3);
  constexpr double kMostVoxels = 1 << 28;
  if (size.prod() > kMostVoxels)
    throw InputError("mesh obstacle: " + std::to_string(size.prod()) + " voxels of " +
                     std::to_string(frame.edge_m) + " m; at most " + std::to_string(1 << 28) +
                     ": cut it to the surroundings of the trees");
  VoxelMesh out;
  out.lo = {first_voxel(bounds.lo.x()) - pad, first_voxel(bounds.lo.y()) - pad,
            first_voxel(bounds.lo.z()) - pad};
  out.nx = last_voxel(bounds.hi.x()) + 2 + pad - out.lo.x;
  out.ny = last_voxel(bounds.hi.y()) + 2 + pad - out.lo.y;
  out.nz = last_voxel(bounds.hi.z()) + 3 - out.lo.z;
  const std::size_t cells =
      static_cast<std::size_t>(out.nx) * static_cast<std::size_t>(out.ny) * static_cast<std::size_t>(out.nz);

  std::vector<char> solid(cells, 0);
  for (const auto& triangle : mesh.triangles) {
    const std::array<Vec3, 3> corner{cell(triangle[0]), cell(triangle[1]), cell(triangle[2])};
    const Vec3 lo = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
    const Vec3 hi = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
    for (std::int32_t z = first_voxel(lo.z() - 1e-6); z <= last_voxel(hi.z() + 1e-6); ++z)
      for (std::int32_t y = first_voxel(lo.y() - 1e-6); y <= last_voxel(hi.y() + 1e-6); ++y)
        for (std::int32_t x = first_voxel(lo.x() - 1e-6); x <= last_voxel(hi.x() + 1e-6); ++x)
          if (overlaps(corner, Vec3(x, y, z))) solid[out.index({x, y, z})] = 1;
  }

  // What a flood from the padding cannot reach is inside a closed surface.
  std::vector<char> outside(cells, 0);
  std::vector<Voxel> front{out.lo};
  outside[0] = 1;
  while (!front.empty()) {
    const Voxel v = front.back();
    front.pop_back();
    const std::array<Voxel, 6> neighbours{{{v.x - 1, v.y, v.z},
                                           {v.x + 1, v.y, v.z},
                                           {v.x, v.y - 1, v.z},
                                           {v.x, v.y + 1, v.z},
                                           {v.x, v.y, v.z - 1},
                                           {v.x, v.y, v.z + 1}}};
    for (const Voxel& n : neighbours) {
      if (!out.holds(n) || outside[out.index(n)] || solid[out.index(n)]) continue;
      outside[out.index(n)] = 1;
      front.push_back(n);
    }
  }

  // Layer by layer from the top: the pyramid above a voxel is its 3 x 3 neighbours' pyramids one layer up.
  out.height.assign(cells, kNoSolid);
  out.below.assign(cells, 0);
  for (std::int32_t z = out.lo.z + out.nz - 1; z >= out.lo.z; --z)
    for (std::int32_t y = out.lo.y; y < out.lo.y + out.ny; ++y)
      for (std::int32_t x = out.lo.x; x < out.lo.x + out.nx; ++x) {
        const std::size_t here = out.index({x, y, z});
        if (!outside[here]) {
          out.height[here] = 0;
          out.below[here] = 1;
          continue;
        }
        int nearest = kNoSolid;
        for (std::int32_t dy = -1; dy <= 1; ++dy)
          for (std::int32_t dx = -1; dx <= 1; ++dx) {
            const Voxel above{x + dx, y + dy, z + 1};
            if (out.holds(above)) nearest = std::min(nearest, out.height[out.index(above)] + 1);
          }
        if (nearest <= kPyramidLayers) out.height[here] = static_cast<std::uint8_t>(nearest);
        const Voxel above{x, y, z + 1};
        out.below[here] = out.holds(above) && out.below[out.index(above)];
      }
  return out;
}

bool Obstacles::solid(const Voxel& v) const {
  for (const VoxelBox& box : boxes_)
    if (v.x >= box.lo.x && v.y >= box.lo.y && v.z >= box.lo.z && v.x <= box.hi.x && v.y <= box.hi.y &&
        v.z <= box.hi.z)
      return true;
  for (const Plane& plane : half_spaces_)
    if (plane.normal.dot(Vec3(v.x, v.y, v.z)) - plane.distance < plane.reach) return true;
  for (const VoxelMesh& mesh : meshes_)
    if (mesh.holds(v) && mesh.height[mesh.index(v)] == 0) return true;
  return false;
}

Fixed Obstacles::shade(const Voxel& v) const {
  Fixed sum = 0;
  for (const VoxelBox& box : boxes_) {
    const std::int32_t dx = std::max({box.lo.x - v.x, v.x - box.hi.x, 0});
    const std::int32_t dy = std::max({box.lo.y - v.y, v.y - box.hi.y, 0});
    const std::int32_t away = std::max(dx, dy);
    if (away == 0 && v.z <= box.hi.z) return kDark;
    const std::int32_t q = std::max(away, box.lo.z - v.z);
    if (v.z + q <= box.hi.z) sum += penumbra(q);
  }
  for (const Plane& plane : half_spaces_) {
    const double gap = plane.normal.dot(Vec3(v.x, v.y, v.z)) - plane.distance - plane.reach;
    if (gap < 0 || plane.normal.z() < 0) return kDark;
    // One layer up and one voxel wider brings the pyramid this much nearer the plane.
    const double gain = std::abs(plane.normal.x()) + std::abs(plane.normal.y()) - plane.normal.z();
    if (gain > 0 && gap <= gain * kPyramidLayers)
      sum += penumbra(static_cast<int>(std::floor(gap / gain)) + 1);
  }
  for (const VoxelMesh& mesh : meshes_) {
    if (mesh.holds(v)) {
      if (mesh.below[mesh.index(v)]) return kDark;
      if (mesh.height[mesh.index(v)] != kNoSolid) sum += penumbra(mesh.height[mesh.index(v)]);
    } else {
      const Voxel lowest{v.x, v.y, mesh.lo.z};
      if (v.z < mesh.lo.z && mesh.holds(lowest) && mesh.below[mesh.index(lowest)]) return kDark;
    }
  }
  return sum;
}

bool Obstacles::blocks(const Vec3& a, const Vec3& b) const {
  if (empty()) return false;
  // Every voxel the piece passes, by stepping from face to face (Amanatides & Woo 1987).
  const Vec3 from = (a - frame_.origin) / frame_.edge_m + Vec3::Constant(0.5);
  const Vec3 along = (b - a) / frame_.edge_m;
  const Voxel last = frame_.at(b);
  Voxel v = frame_.at(a);
  std::array<std::int32_t*, 3> cell{&v.x, &v.y, &v.z};
  std::array<int, 3> step{};
  Vec3 next, stride;
  for (int i = 0; i < 3; ++i) {
    step[static_cast<std::size_t>(i)] = along[i] > 0 ? 1 : -1;
    const double face = std::floor(from[i]) + (along[i] > 0 ? 1 : 0);
    next[i] = along[i] == 0 ? std::numeric_limits<double>::infinity() : (face - from[i]) / along[i];
    stride[i] = along[i] == 0 ? std::numeric_limits<double>::infinity() : 1 / std::abs(along[i]);
  }
  while (!(v == last)) {
    int axis = 0;
    next.minCoeff(&axis);
    if (next[axis] > 1) break;
    *cell[static_cast<std::size_t>(axis)] += step[static_cast<std::size_t>(axis)];
    next[axis] += stride[axis];
    if (solid(v)) return true;
  }
  return solid(last);
}

}  // namespace dendrofit
