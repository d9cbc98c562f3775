// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace dendrofit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEndlessLog = 46;      // e^46: 20 powers of ten from the estimate
constexpr double kEndlessLinear = 1e6;  // standard steps

struct ProfilePoint {
  double x = 0;      // the profiled coordinate
  double z = 0;      // root of the rise over sigma^2
  double slope = 0;  // dz/dx
  GrowthVector c;
};

class Profile {
 public:
  Profile(const GrowthProblem& problem, int coordinate, double rss, double variance)
      : problem_(problem), coordinate_(coordinate), rss_(rss), variance_(variance) {
    problem_.held[coordinate] = true;
  }

  ProfilePoint at(double x, GrowthVector guess) {
    guess[coordinate_] = x;
    const GrowthSolution inner = minimize_directly(problem_, guess, 400, 1e-7);
    if (inner.rss < lowest_) {
      lowest_ = inner.rss;
      lowest_at_ = inner.c;
    }
    ProfilePoint point{x, std::sqrt(std::max(0.0, inner.rss - rss_) / variance_), 0, inner.c};
    // Envelope theorem: only the profiled coordinate's own derivative is left at the inner optimum.
    if (point.z > 0 && problem_.evaluate(inner.c, residuals_, &jacobian_))
      point.slope = jacobian_.col(coordinate_).dot(residuals_) / (variance_ * point.z);
    return point;
  }

  // The lowest of several guesses.
  ProfilePoint at(double x, const std::vector<GrowthVector>& guesses) {
    ProfilePoint best = at(x, guesses.front());
    for (std::size_t i = 1; i < guesses.size(); ++i)
      if (const ProfilePoint other = at(x, guesses[i]); other.z < best.z) best = other;
    return best;
  }

  double lowest() const { return lowest_; }
  const GrowthVector& lowest_at() const { return lowest_at_; }

 private:
  GrowthProblem problem_;
  int coordinate_;
  double rss_, variance_;
  double lowest_ = kInfinity;
  GrowthVector lowest_at_;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd jacobian_;
};

// The others' coordinates at x on the line through two profile points.
GrowthVector extrapolated(const ProfilePoint& a, const ProfilePoint& b, double x) {
  if (a.x == b.x) return b.c;
  return b.c + (b.c - a.c) * ((x - b.x) / (b.x - a.x));
}

// The x beyond `start` in direction `side` where z = threshold; infinite where there is none.
double find_limit(Profile& profile, const ProfilePoint& start, double side, double first_step,
                  double threshold, double end, bool logarithmic) {
  ProfilePoint inner = start, before = start;
  double step = first_step;
  ProfilePoint outer;
  const double endless = logarithmic ? kEndlessLog : kEndlessLinear * first_step;
  for (int tries = 0;; ++tries) {
    if (tries == 400) return side * kInfinity;
    double x = inner.x + side * step;
    const bool last = side * (x - end) >= 0;
    if (last) x = end;
    ProfilePoint next = profile.at(x, extrapolated(before, inner, x));
    // Outside, so it seems: a far guess may have ended in another valley.
    if (next.z >= threshold) next = profile.at(x, {next.c, inner.c, start.c});
    if (next.z >= threshold) {
      outer = next;
      break;
    }
    if (last) return end;  // the user's bound comes first
    if (std::abs(next.x - start.x) > endless) return side * kInfinity;
    before = inner;
    inner = next;
    const double newton = next.slope * side > 0 ? (threshold - next.z) / (next.slope * side) : kInfinity;
    step = std::clamp(1.05 * newton, 0.1 * step, 2.5 * step);
    step = std::max(step, 1e-12 * (std::abs(start.x) + first_step));
  }
  if (std::isinf(outer.z)) outer.slope = 0;
  // Newton from the nearer side, halving where it leaves the bracket.
  ProfilePoint now = threshold - inner.z < outer.z - threshold && inner.z > 0 ? inner : outer;
  for (int i = 0; i < 60; ++i) {
    double x = now.x + (now.slope != 0 ? (threshold - now.z) / now.slope : kInfinity);
    const double lo = std::min(inner.x, outer.x), hi = std::max(inner.x, outer.x);
    if (!(x > lo && x < hi)) x = 0.5 * (lo + hi);
    if (x == now.x || hi - lo < 1e-13 * (std::abs(lo) + std::abs(hi))) return x;
    now = profile.at(x, extrapolated(inner, outer, x));
    if (now.z > outer.z) now = profile.at(x, {now.c, inner.c, outer.c});
    if (std::abs(now.z - threshold) < 1e-10 * threshold) return now.x;
    (now.z < threshold ? inner : outer) = now;
  }
  return now.x;
}

}  // namespace

ProfileLimits profile_limits(const GrowthProblem& given, const GrowthVector& natural, double rss, int degrees,
                             double threshold, int row, double se) {
  GrowthProblem problem = given;
  const GrowthCurve& curve = *given.curve;
  int coordinate = row;
  if (const auto own = curve.coordinate(given.chart, row)) {
    coordinate = *own;
  } else {
    // Mixed in the shape chart: there are then no bounds and nothing is held, so the chart can change.
    problem = GrowthProblem(curve, GrowthChart::natural, *given.data);
  }
  const bool logarithmic = curve.is_positive(row);
  ProfilePoint start;
  start.c = curve.to_chart(problem.chart, natural);
  start.x = start.c[coordinate];
  Profile profile(problem, coordinate, rss, rss / degrees);
  double step = threshold * (logarithmic ? se / natural[row] : se);
  if (!std::isfinite(step) || step <= 0) step = 1;
  if (logarithmic) step = std::min(step, 1.0);
  ProfileLimits limits;
  const double lo = find_limit(profile, start, -1, step, threshold, problem.lo[coordinate], logarithmic);
  const double hi = find_limit(profile, start, 1, step, threshold, problem.hi[coordinate], logarithmic);
  limits.lo = logarithmic ? std::exp(lo) : lo;
  limits.hi = logarithmic ? std::exp(hi) : hi;
  if (profile.lowest() < rss * (1 - 1e-7))
    limits.better = curve.to_natural(problem.chart, profile.lowest_at());
  return limits;
}

}  // namespace dendrofit
