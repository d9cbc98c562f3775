// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/virtual_scan/ray_scene.h"

#include "core/errors.h"
#include "core/mesh.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace dendrofit {
namespace {

/// A frustum with flat ends; a ball at the far end fills the gap to a cylinder that bends away.
struct Cone {
  Vec3 from, axis;  // axis unit
  double length, r0, r1;
  double ball;  // radius of the ball at the far end, 0 none
};

std::vector<Cone> cones_of(const Tree& tree, bool tapered, const Vec3& centre) {
  std::vector<Cone> cones;
  std::vector<std::int32_t> next(tree.size(), -1);  // along the axis
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] >= 0 && tree.axis[static_cast<std::size_t>(tree.parent[i])] == tree.axis[i])
      next[static_cast<std::size_t>(tree.parent[i])] = static_cast<std::int32_t>(i);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    Cone cone{tree.start[i] - centre, tree.direction(i), tree.length(i), tree.radius[i], tree.radius[i], 0};
    const std::int32_t parent = tree.parent[i];
    if (tapered && parent >= 0 && next[static_cast<std::size_t>(parent)] == static_cast<std::int32_t>(i))
      cone.r0 = 0.5 * (tree.radius[i] + tree.radius[static_cast<std::size_t>(parent)]);
    if (next[i] >= 0) {
      if (tapered) cone.r1 = 0.5 * (tree.radius[i] + tree.radius[static_cast<std::size_t>(next[i])]);
      cone.ball = std::min(cone.r1, tree.radius[static_cast<std::size_t>(next[i])]);
    }
    cones.push_back(cone);
  }
  return cones;
}

// Nearest t > t_min at which origin + t direction enters the solid; infinity where it does not.
double enter(const Cone& cone, const Vec3& origin, const Vec3& direction, double t_min) {
  double best = std::numeric_limits<double>::infinity();
  const auto offer = [&](double t) {
    if (t > t_min && t < best) best = t;
  };
  const Vec3 to = origin - cone.from;
  const double h = to.dot(cone.axis), dh = direction.dot(cone.axis);
  const Vec3 p = to - h * cone.axis, d = direction - dh * cone.axis;
  // |p + t d| = r0 + k (h + t dh)
  const double k = (cone.r1 - cone.r0) / cone.length, r = cone.r0 + k * h;
  const double a = d.squaredNorm() - k * k * dh * dh, b = p.dot(d) - k * dh * r, c = p.squaredNorm() - r * r;
  const auto on_side = [&](double t) {
    const double at = h + t * dh;
    if (at >= 0 && at <= cone.length && cone.r0 + k * at >= 0) offer(t);
  };
  if (std::abs(a) > 1e-15) {
    const double discriminant = b * b - a * c;
    if (discriminant >= 0) {
      const double root = std::sqrt(discriminant), q = -(b + std::copysign(root, b));
      on_side(q / a);
      if (q != 0) on_side(c / q);
    }
  } else if (b != 0) {
    on_side(-c / (2 * b));
  }
  if (std::abs(dh) > 1e-15) {
    const double t0 = -h / dh, t1 = (cone.length - h) / dh;
    if ((p + t0 * d).squaredNorm() <= cone.r0 * cone.r0) offer(t0);
    if ((p + t1 * d).squaredNorm() <= cone.r1 * cone.r1) offer(t1);
  }
  if (cone.ball > 0) {
    const Vec3 m = to - cone.length * cone.axis;
    const double bb = m.dot(direction), cc = m.squaredNorm() - cone.ball * cone.ball;
    const double discriminant = bb * bb - cc;
    if (discriminant >= 0) {
      offer(-bb - std::sqrt(discriminant));
      offer(-bb + std::sqrt(discriminant));
    }
  }
  return best;
}

void cone_bounds(const RTCBoundsFunctionArguments* args) {
  const Cone& cone = static_cast<const Cone*>(args->geometryUserPtr)[args->primID];
  const double radius = std::max({cone.r0, cone.r1, cone.ball}) * 1.0001 + 1e-6;
  const Vec3 to = cone.from + cone.length * cone.axis;
  const Vec3 lo = cone.from.cwiseMin(to) - Vec3::Constant(radius),
             hi = cone.from.cwiseMax(to) + Vec3::Constant(radius);
  RTCBounds* out = args->bounds_o;
  out->lower_x = static_cast<float>(lo.x()), out->lower_y = static_cast<float>(lo.y());
  out->lower_z = static_cast<float>(lo.z());
  out->upper_x = static_cast<float>(hi.x()), out->upper_y = static_cast<float>(hi.y());
  out->upper_z = static_cast<float>(hi.z());
}

void cone_intersect(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const Cone& cone = static_cast<const Cone*>(args->geometryUserPtr)[args->primID];
  auto* ray_hit = reinterpret_cast<RTCRayHit*>(args->rayhit);  // rays come one by one
  const RTCRay& ray = ray_hit->ray;
  const double t =
      enter(cone, Vec3(ray.org_x, ray.org_y, ray.org_z), Vec3(ray.dir_x, ray.dir_y, ray.dir_z), ray.tnear);
  if (!(t < ray.tfar)) return;
  ray_hit->ray.tfar = static_cast<float>(t);
  ray_hit->hit.geomID = args->geomID;
  ray_hit->hit.primID = args->primID;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Cone> cones;
  std::vector<std::int32_t> leaf_of_triangle;
  unsigned wood_id = RTC_INVALID_GEOMETRY_ID;
  Vec3 centre = Vec3::Zero();
  std::optional<GroundDisc> ground;

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

RayScene::RayScene(const Tree& tree, const Foliage* foliage, bool tapered, const Vec3& centre,
                   const std::optional<GroundDisc>& ground)
    : impl_(std::make_unique<Impl>()) {
  impl_->centre = centre;
  impl_->ground = ground;
  impl_->cones = cones_of(tree, tapered, centre);
  impl_->device = rtcNewDevice("threads=1");
  if (!impl_->device) throw SolverError("the ray tracer (Embree) does not start on this machine");
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);

  RTCGeometry wood = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(wood, static_cast<unsigned>(impl_->cones.size()));
  rtcSetGeometryUserData(wood, impl_->cones.data());
  rtcSetGeometryBoundsFunction(
      wood, [](const RTCBoundsFunctionArguments* args) { cone_bounds(args); }, nullptr);
  rtcSetGeometryIntersectFunction(wood,
                                  [](const RTCIntersectFunctionNArguments* args) { cone_intersect(args); });
  rtcCommitGeometry(wood);
  impl_->wood_id = rtcAttachGeometry(impl_->scene, wood);
  rtcReleaseGeometry(wood);

  if (foliage && foliage->size() > 0) {
    TriangleMesh blades;
    for (std::size_t i = 0; i < foliage->size(); ++i) {
      foliage->append_blade(i, blades);
      impl_->leaf_of_triangle.resize(blades.triangles.size(), static_cast<std::int32_t>(i));
    }
    RTCGeometry leaves = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
        leaves, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), blades.vertices.size()));
    for (const Vec3& v : blades.vertices)
      for (int axis = 0; axis < 3; ++axis) *vertex++ = static_cast<float>(v[axis] - centre[axis]);
    auto* corner = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        leaves, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), blades.triangles.size()));
    for (const auto& triangle : blades.triangles)
      for (const std::uint32_t v : triangle) *corner++ = v;
    rtcCommitGeometry(leaves);
    rtcAttachGeometry(impl_->scene, leaves);
    rtcReleaseGeometry(leaves);
  }
  rtcCommitScene(impl_->scene);
}

RayScene::~RayScene() = default;

RayHit RayScene::cast(const Vec3& origin, const Vec3& direction, double max_range_m, double grass_m) const {
  const Vec3 from = origin - impl_->centre;
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(from.x()), query.ray.org_y = static_cast<float>(from.y());
  query.ray.org_z = static_cast<float>(from.z());
  query.ray.dir_x = static_cast<float>(direction.x()), query.ray.dir_y = static_cast<float>(direction.y());
  query.ray.dir_z = static_cast<float>(direction.z());
  query.ray.tnear = 0;
  query.ray.tfar = static_cast<float>(max_range_m);
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(impl_->scene, &query);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
#endif

  RayHit hit;
  if (query.hit.geomID == impl_->wood_id)
    hit = {RayHit::What::wood, static_cast<std::int32_t>(query.hit.primID), query.ray.tfar};
  else if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
    hit = {RayHit::What::leaf, impl_->leaf_of_triangle[query.hit.primID], query.ray.tfar};
  if (!impl_->ground) return hit;
  const GroundDisc& ground = *impl_->ground;
  const double sinking = ground.rise * direction.x() - direction.z();  // towards the ground, along the ray
  if (sinking > 0) {
    const double t = (from.z() - ground.rise * from.x() - grass_m) / sinking;
    const Vec3 at = from + t * direction;
    const double reach = hit.what == RayHit::What::nothing ? max_range_m : hit.range_m;
    if (t > 0 && t < reach && std::hypot(at.x(), at.y()) <= ground.radius_m)
      hit = {grass_m > 0 ? RayHit::What::grass : RayHit::What::ground, -1, t};
  }
  return hit;
}

}  // namespace dendrofit
