// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/cmaes.h"

#include "core/errors.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using Function = std::function<double(const Eigen::VectorXd&)>;

/// Best point after at most `evaluations`.
Eigen::VectorXd minimise(const Function& f, Eigen::Index n, int evaluations, std::uint64_t seed = 1) {
  Cmaes cmaes(Eigen::VectorXd::Constant(n, 0.5), {.seed = seed});
  for (int used = 0; used + cmaes.population() <= evaluations && !cmaes.converged(1e-9);
       used += cmaes.population()) {
    std::vector<double> costs;
    for (const auto& x : cmaes.ask()) costs.push_back(f(x));
    cmaes.tell(costs);
  }
  return cmaes.mean();
}

TEST(Cmaes, finds_the_minimum_of_a_narrow_curved_valley) {
  // Rosenbrock's valley on [-2, 2]^5: minimum at 1, i.e. 0.75 in the unit box
  const auto rosenbrock = [](const Eigen::VectorXd& unit) {
    const Eigen::ArrayXd x = 4 * unit.array() - 2;
    double sum = 0;
    for (Eigen::Index i = 0; i + 1 < x.size(); ++i)
      sum += 100 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1 - x[i], 2);
    return sum;
  };
  const Eigen::VectorXd found = minimise(rosenbrock, 5, 8000);
  EXPECT_LT((found.array() - 0.75).abs().maxCoeff(), 1e-4);
}

TEST(Cmaes, reaches_a_minimum_on_the_boundary_and_stays_inside) {
  bool inside = true;
  const auto corner = [&](const Eigen::VectorXd& x) {
    inside &= x.minCoeff() >= 0 && x.maxCoeff() <= 1;
    return x.sum();
  };
  minimise(corner, 4, 3000);
  EXPECT_TRUE(inside);
  double best = 1e9;
  minimise(
      [&](const Eigen::VectorXd& x) {
        best = std::min(best, x.sum());
        return x.sum();
      },
      4, 3000);
  EXPECT_LT(best, 1e-3);
}

TEST(Cmaes, scales_differing_a_thousandfold) {
  const auto ellipse = [](const Eigen::VectorXd& x) {
    double sum = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) sum += std::pow(10.0, double(i)) * std::pow(x[i] - 0.3, 2);
    return sum;
  };
  EXPECT_LT((minimise(ellipse, 7, 6000).array() - 0.3).abs().maxCoeff(), 1e-4);
}

TEST(Cmaes, same_seed_same_path_and_other_seed_another) {
  const auto sphere = [](const Eigen::VectorXd& x) { return (x.array() - 0.2).square().sum(); };
  EXPECT_EQ(minimise(sphere, 3, 200, 5), minimise(sphere, 3, 200, 5));
  EXPECT_NE(minimise(sphere, 3, 200, 5), minimise(sphere, 3, 200, 6));
}

TEST(Cmaes, a_cost_that_is_no_number_counts_as_worst) {
  const auto half_blind = [](const Eigen::VectorXd& x) {
    return x[0] > 0.5 ? NAN : std::pow(x[0] - 0.4, 2) + std::pow(x[1] - 0.6, 2);
  };
  const Eigen::VectorXd found = minimise(half_blind, 2, 1500);
  EXPECT_NEAR(found[0], 0.4, 1e-3);
  EXPECT_NEAR(found[1], 0.6, 1e-3);
}

TEST(Cmaes, refuses_nonsense_options) {
  EXPECT_THROW(Cmaes(Eigen::VectorXd::Zero(2), {.initial_step = 0}), InputError);
  EXPECT_THROW(Cmaes(Eigen::VectorXd::Zero(2), {.population = 2}), InputError);
}

}  // namespace
}  // namespace dendrofit
