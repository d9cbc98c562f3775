// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/ellipse_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace dendrofit {

std::optional<EllipseFit> fit_ellipse(std::span<const Eigen::Vector2d> points) {
  if (points.size() < 8) return std::nullopt;
  const auto n = static_cast<double>(points.size());
  Eigen::Vector2d mean(0, 0);
  for (const auto& p : points) mean += p / n;
  double scale = 0;
  for (const auto& p : points) scale += (p - mean).norm() / n;
  if (!(scale > 0)) return std::nullopt;
  // Scatter of the quadratic terms (x2, xy, y2) and the linear ones (x, y, 1).
  Eigen::Matrix3d s1 = Eigen::Matrix3d::Zero(), s2 = s1, s3 = s1;
  for (const auto& p : points) {
    const Eigen::Vector2d d = (p - mean) / scale;
    const Eigen::Vector3d square(d.x() * d.x(), d.x() * d.y(), d.y() * d.y()), line(d.x(), d.y(), 1);
    s1 += square * square.transpose();
    s2 += square * line.transpose();
    s3 += line * line.transpose();
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(s3);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::Matrix3d linear = -lu.solve(s2.transpose());
  const Eigen::Matrix3d m = s1 + s2 * linear;
  Eigen::Matrix3d reduced;  // the constraint 4 a c - b2 = 1, inverted
  reduced.row(0) = m.row(2) / 2;
  reduced.row(1) = -m.row(1);
  reduced.row(2) = m.row(0) / 2;
  const Eigen::EigenSolver<Eigen::Matrix3d> solver(reduced);
  for (int k = 0; k < 3; ++k) {
    if (std::abs(solver.eigenvalues()[k].imag()) > 1e-9) continue;
    const Eigen::Vector3d q = solver.eigenvectors().col(k).real();
    if (!(4 * q[0] * q[2] - q[1] * q[1] > 0)) continue;
    const Eigen::Vector3d l = linear * q;
    Eigen::Matrix2d shape;
    shape << q[0], q[1] / 2, q[1] / 2, q[2];
    const Eigen::Vector2d half(l[0] / 2, l[1] / 2);
    const double level = half.dot(shape.inverse() * half) - l[2];  // of the form about its centre
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(shape);
    const double a = level / axes.eigenvalues()[0], b = level / axes.eigenvalues()[1];
    if (!(a > 0) || !(b > 0)) return std::nullopt;
    return EllipseFit{2 * scale * std::sqrt(std::max(a, b)), 2 * scale * std::sqrt(std::min(a, b))};
  }
  return std::nullopt;
}

}  // namespace dendrofit
