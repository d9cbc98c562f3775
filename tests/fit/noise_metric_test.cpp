// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/noise_metric.h"

#include "core/errors.h"
#include "core/random.h"
#include "fit/descriptors.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Descriptors that follow the parameters linearly with correlated noise of sd 1.
struct World {
  Eigen::Index m = static_cast<Eigen::Index>(descriptor_table().size());
  Eigen::VectorXd error = Eigen::VectorXd::Constant(m, 0.1);
  Random random{4};

  Eigen::RowVectorXd draw(const Eigen::RowVectorXd& theta, double noise = 1) {
    Eigen::RowVectorXd d(m);
    const double shared = random.normal();
    for (Eigen::Index j = 0; j < m; ++j)
      d[j] = 20 * theta[j % 3] + noise * (0.6 * shared + 0.8 * random.normal());
    return d;
  }
  Eigen::MatrixXd trees(const Eigen::RowVectorXd& theta, int count, double noise = 1) {
    Eigen::MatrixXd rows(count, m);
    for (int k = 0; k < count; ++k) rows.row(k) = draw(theta, noise);
    return rows;
  }
  /// Of sixty parameter sets.
  SeedNoise typical() {
    std::vector<Eigen::MatrixXd> groups;
    for (int g = 0; g < 60; ++g) {
      Eigen::RowVectorXd theta(3);
      for (double& u : theta) u = random.uniform();
      groups.push_back(trees(theta, 6));
    }
    return noise_within(groups);
  }
};

TEST(NoiseMetric, another_seed_of_the_same_tree_is_at_distance_one) {
  World world;
  const Eigen::RowVectorXd theta = Eigen::RowVectorXd::Constant(3, 0.5);
  const SeedNoise typical = world.typical();
  const Eigen::MatrixXd replicates = world.trees(theta, 16);
  for (const int seeds : {1, 4}) {
    double sum = 0;
    for (int k = 0; k < 100; ++k) {
      const NoiseMetric metric(typical, replicates, world.draw(theta).transpose(), world.error);
      sum += metric.cost(world.trees(theta, seeds));
    }
    // below 1 since the scan's own error, which these draws lack, is part of the metric
    EXPECT_GT(sum / 100, 0.4);
    EXPECT_LT(sum / 100, 1.15);
  }
}

TEST(NoiseMetric, other_parameters_are_farther) {
  World world;
  const Eigen::RowVectorXd here = Eigen::RowVectorXd::Constant(3, 0.5);
  const Eigen::RowVectorXd there = Eigen::RowVectorXd::Constant(3, 1.0);
  const NoiseMetric metric(world.typical(), world.trees(here, 16), world.draw(here).transpose(), world.error);
  EXPECT_GT(metric.cost(world.draw(there)), 2 * metric.cost(world.draw(here)));
}

TEST(NoiseMetric, descriptors_that_the_tree_lacks_are_not_used_and_those_a_simulation_lacks_cost) {
  World world;
  Eigen::VectorXd observed = world.draw(Eigen::RowVectorXd::Constant(3, 0.5)).transpose();
  observed[2] = kNone;
  const NoiseMetric metric(world.typical(), Eigen::MatrixXd(0, world.m), observed, world.error);
  EXPECT_EQ(static_cast<Eigen::Index>(metric.used().size()), world.m - 1);
  EXPECT_TRUE(std::isnan(metric.noise(2)));
  Eigen::RowVectorXd simulation = observed.transpose();
  const double near = metric.cost(simulation);
  simulation[5] = kNone;
  EXPECT_NEAR(metric.cost(simulation) - near, 9.0 / double(world.m - 1), 1e-9);
}

TEST(NoiseMetric, trees_that_differ_wildly_widen_the_noise_to_twice_the_typical_at_most) {
  World world;
  const Eigen::RowVectorXd theta = Eigen::RowVectorXd::Constant(3, 0.5);
  const SeedNoise typical = world.typical();
  const NoiseMetric wild(typical, world.trees(theta, 16, 50), world.draw(theta).transpose(), world.error);
  const NoiseMetric calm(typical, world.trees(theta, 16, 0.01), world.draw(theta).transpose(), world.error);
  for (Eigen::Index j = 0; j < world.m; ++j) {
    EXPECT_NEAR(wild.noise(j), std::hypot(2 * typical.deviation(j), 0.1), 1e-9);
    EXPECT_NEAR(calm.noise(j), std::hypot(0.5 * typical.deviation(j), 0.1), 1e-9);
  }
}

TEST(NoiseMetric, nothing_in_common_is_said) {
  World world;
  EXPECT_THROW(NoiseMetric(world.typical(), Eigen::MatrixXd(0, world.m),
                           Eigen::VectorXd::Constant(world.m, kNone), world.error),
               SolverError);
}

}  // namespace
}  // namespace dendrofit
