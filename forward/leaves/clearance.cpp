// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/clearance.h"

#include "core/range.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

using Triangle = std::array<const Vec3*, 3>;

template <class Points>
Range range_along(const Vec3& axis, const Points& points) {
  Range range;
  for (const Vec3& p : points) range.add(axis.dot(p));
  return range;
}

bool apart(const Range& a, const Range& b, double gap) {
  return a.lo - b.hi > gap || b.lo - a.hi > gap;
}

/// Does the blade end, along axis k of its own frame, before the points begin?
template <class Points>
bool blade_apart_along(const LeafBody& leaf, std::size_t k, const Points& points, double gap) {
  return apart({leaf.from[k], leaf.to[k]}, range_along(leaf.frame[k], points), gap);
}

bool boxes_apart(const Vec3& alo, const Vec3& ahi, const Vec3& blo, const Vec3& bhi, double gap) {
  return ((alo - bhi).array() > gap).any() || ((blo - ahi).array() > gap).any();
}

/// Gap along an axis of any length; a vanishing axis separates nothing.
bool triangles_apart_along(const Vec3& axis, const Triangle& a, const Triangle& b, double gap) {
  const double norm2 = axis.squaredNorm();
  if (norm2 < 1e-30) return false;
  Range ra, rb;
  // From a shared corner, so that far-off coordinates cost no digits.
  const Vec3& o = *a[0];
  for (int i = 0; i < 3; ++i) {
    ra.add(axis.dot(*a[static_cast<std::size_t>(i)] - o));
    rb.add(axis.dot(*b[static_cast<std::size_t>(i)] - o));
  }
  const double distance = std::max(ra.lo - rb.hi, rb.lo - ra.hi);
  return distance > 0 && distance * distance > gap * gap * norm2;
}

struct Corners {
  Triangle corner;
  Vec3 lo, hi;
};

Corners corners_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{&a, &b, &c}, a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

Corners blade_triangle(const LeafBody& leaf, std::size_t k) {
  const auto& t = leaf.shape->triangles[k];
  return corners_of(leaf.blade[t[0]], leaf.blade[t[1]], leaf.blade[t[2]]);
}

Corners petiole_triangle(const LeafBody& leaf, std::size_t k) {
  return corners_of(leaf.petiole[0], leaf.petiole[k + 1], leaf.petiole[k + 2]);
}

bool blades_clear(const LeafBody& a, const LeafBody& b, double gap) {
  if (boxes_apart(a.blade_lo, a.blade_hi, b.blade_lo, b.blade_hi, gap)) return true;
  // Blades are thin: a face or an edge plane of either usually parts them.
  for (const int k : {2, 0, 1}) {
    if (blade_apart_along(a, static_cast<std::size_t>(k), b.blade, gap)) return true;
    if (blade_apart_along(b, static_cast<std::size_t>(k), a.blade, gap)) return true;
  }
  for (std::size_t i = 0; i < a.shape->triangles.size(); ++i) {
    const Corners ta = blade_triangle(a, i);
    if (boxes_apart(ta.lo, ta.hi, b.blade_lo, b.blade_hi, gap)) continue;
    for (std::size_t j = 0; j < b.shape->triangles.size(); ++j) {
      const Corners tb = blade_triangle(b, j);
      if (boxes_apart(ta.lo, ta.hi, tb.lo, tb.hi, gap)) continue;
      if (!triangles_clear(ta.corner, tb.corner, gap)) return false;
    }
  }
  return true;
}

bool petiole_clear_of_blade(const LeafBody& with_petiole, const LeafBody& blade, double gap) {
  if (blade_apart_along(blade, 2, with_petiole.petiole, gap)) return true;
  for (std::size_t k = 0; k < 2; ++k) {
    const Corners tp = petiole_triangle(with_petiole, k);
    if (boxes_apart(tp.lo, tp.hi, blade.blade_lo, blade.blade_hi, gap)) continue;
    for (std::size_t j = 0; j < blade.shape->triangles.size(); ++j) {
      const Corners tb = blade_triangle(blade, j);
      if (boxes_apart(tp.lo, tp.hi, tb.lo, tb.hi, gap)) continue;
      if (!triangles_clear(tp.corner, tb.corner, gap)) return false;
    }
  }
  return true;
}

bool petioles_clear(const LeafBody& a, const LeafBody& b, double gap) {
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      const Corners ta = petiole_triangle(a, i), tb = petiole_triangle(b, j);
      if (!boxes_apart(ta.lo, ta.hi, tb.lo, tb.hi, gap) && !triangles_clear(ta.corner, tb.corner, gap))
        return false;
    }
  return true;
}

struct Flat {
  double x, y, z;
};

/// Convex polygon cut to zlo <= z <= zhi. Returns the number of corners; `in` holds a triangle, `out` up
/// to 5.
int cut_to_slab(const std::array<Flat, 3>& in, double zlo, double zhi, std::array<Flat, 8>& out) {
  std::array<Flat, 8> work{in[0], in[1], in[2]};
  int n = 3;
  for (const double sign : {1.0, -1.0}) {
    const double limit = sign > 0 ? zhi : -zlo;
    int m = 0;
    for (int i = 0; i < n; ++i) {
      const Flat& p = work[static_cast<std::size_t>(i)];
      const Flat& q = work[static_cast<std::size_t>((i + 1) % n)];
      const double dp = limit - sign * p.z, dq = limit - sign * q.z;
      if (dp >= 0) out[static_cast<std::size_t>(m++)] = p;
      if ((dp >= 0) != (dq >= 0)) {
        const double s = dp / (dp - dq);
        out[static_cast<std::size_t>(m++)] = {p.x + s * (q.x - p.x), p.y + s * (q.y - p.y),
                                              p.z + s * (q.z - p.z)};
      }
    }
    n = m;
    work = out;
  }
  return n;
}

double distance2_to_edge(const Flat& p, const Flat& q) {
  const double ex = q.x - p.x, ey = q.y - p.y, e2 = ex * ex + ey * ey;
  const double s = e2 > 0 ? std::clamp(-(p.x * ex + p.y * ey) / e2, 0.0, 1.0) : 0.0;
  const double x = p.x + s * ex, y = p.y + s * ey;
  return x * x + y * y;
}

/// Triangle in the cylinder's frame: keeps more than `gap` from the solid?
bool flat_triangle_clear(const std::array<Flat, 3>& t, double length, double radius, double gap) {
  std::array<Flat, 8> polygon;
  const int n = cut_to_slab(t, -gap, length + gap, polygon);
  if (n == 0) return true;
  const double limit = (radius + gap) * (radius + gap);
  bool left = true, right = true;
  for (int i = 0; i < n; ++i) {
    const Flat& p = polygon[static_cast<std::size_t>(i)];
    const Flat& q = polygon[static_cast<std::size_t>((i + 1) % n)];
    if (distance2_to_edge(p, q) <= limit) return false;
    const double turn = p.x * q.y - p.y * q.x;
    left &= turn >= 0;
    right &= turn <= 0;
  }
  return !left && !right;  // the axis passes through the polygon, all its edges far away
}

}  // namespace

SolidCylinder solid_cylinder(const Vec3& start, const Vec3& end, double radius) {
  SolidCylinder c;
  c.base = start;
  c.length = (end - start).norm();
  c.axis = c.length > 0 ? Vec3((end - start) / c.length) : Vec3::UnitZ();
  c.side = c.axis.unitOrthogonal();
  c.other = c.axis.cross(c.side);
  c.radius = radius;
  return c;
}

BodyPlan::BodyPlan(const LeafShape& s) {
  for (const Vec3& v : s.vertices) {
    reach = std::max(reach, v.norm());
    for (const Vec3& w : s.vertices) width = std::max(width, (v - w).norm());
  }
}

void LeafBody::set(const Leaf& leaf, const LeafShape& s) {
  shape = &s;
  frame = {leaf.direction.cross(leaf.normal), leaf.direction, leaf.normal};
  blade_vertices(leaf, s, blade);
  blade_lo = blade_hi = blade.front();
  for (const Vec3& v : blade) {
    blade_lo = blade_lo.cwiseMin(v);
    blade_hi = blade_hi.cwiseMax(v);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Range range = range_along(frame[k], blade);
    from[k] = range.lo;
    to[k] = range.hi;
  }
  lo = blade_lo;
  hi = blade_hi;
  has_petiole = petiole_corners(leaf, s, petiole);
  if (has_petiole)
    for (const Vec3& v : petiole) {
      lo = lo.cwiseMin(v);
      hi = hi.cwiseMax(v);
    }
}

bool triangles_clear(const Triangle& a, const Triangle& b, double gap) {
  const std::array<Vec3, 3> ea{*a[1] - *a[0], *a[2] - *a[1], *a[0] - *a[2]};
  const std::array<Vec3, 3> eb{*b[1] - *b[0], *b[2] - *b[1], *b[0] - *b[2]};
  const Vec3 na = ea[0].cross(ea[1]), nb = eb[0].cross(eb[1]);
  if (triangles_apart_along(na, a, b, gap) || triangles_apart_along(nb, a, b, gap)) return true;
  for (const Vec3& p : ea)
    for (const Vec3& q : eb)
      if (triangles_apart_along(p.cross(q), a, b, gap)) return true;
  // In one plane the products above vanish; the edges' normals within the plane decide.
  for (const Vec3& p : ea)
    if (triangles_apart_along(na.cross(p), a, b, gap)) return true;
  for (const Vec3& q : eb)
    if (triangles_apart_along(nb.cross(q), a, b, gap)) return true;
  return false;
}

bool leaves_clear(const LeafBody& a, const LeafBody& b, double gap) {
  if (boxes_apart(a.lo, a.hi, b.lo, b.hi, gap)) return true;
  if (!blades_clear(a, b, gap)) return false;
  if (a.has_petiole && !petiole_clear_of_blade(a, b, gap)) return false;
  if (b.has_petiole && !petiole_clear_of_blade(b, a, gap)) return false;
  return !a.has_petiole || !b.has_petiole || petioles_clear(a, b, gap);
}

bool cylinder_clear(const LeafBody& leaf, const SolidCylinder& c, double gap) {
  const auto flat = [&](const Vec3& p) {
    const Vec3 d = p - c.base;
    return Flat{c.side.dot(d), c.other.dot(d), c.axis.dot(d)};
  };
  // A cylinder lies within its radius of its axis: past a side of the blade's own box it is far.
  const double far = c.radius + gap;
  bool blade_far = false;
  for (std::size_t k = 0; k < 3 && !blade_far; ++k) {
    const double base = leaf.frame[k].dot(c.base), tip = base + c.length * leaf.frame[k].dot(c.axis);
    blade_far = std::min(base, tip) - leaf.to[k] > far || leaf.from[k] - std::max(base, tip) > far;
  }
  if (!blade_far) {
    thread_local std::vector<Flat> corner;
    corner.clear();
    Range x, y, z;
    for (const Vec3& v : leaf.blade) {
      corner.push_back(flat(v));
      x.add(corner.back().x);
      y.add(corner.back().y);
      z.add(corner.back().z);
    }
    const bool outside =
        z.lo > c.length + gap || z.hi < -gap || x.lo > far || x.hi < -far || y.lo > far || y.hi < -far;
    if (!outside)
      for (const auto& t : leaf.shape->triangles)
        if (!flat_triangle_clear({corner[t[0]], corner[t[1]], corner[t[2]]}, c.length, c.radius, gap))
          return false;
  }
  if (!leaf.has_petiole) return true;
  const std::array<Flat, 4> p = {flat(leaf.petiole[0]), flat(leaf.petiole[1]), flat(leaf.petiole[2]),
                                 flat(leaf.petiole[3])};
  return flat_triangle_clear({p[0], p[1], p[2]}, c.length, c.radius, gap) &&
         flat_triangle_clear({p[0], p[2], p[3]}, c.length, c.radius, gap);
}

}  // namespace dendrofit
