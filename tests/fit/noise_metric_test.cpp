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
  Eigen::MatrixXd parameters{300, 3};
  Eigen::MatrixXd descriptors{300, m};
  Eigen::VectorXd error = Eigen::VectorXd::Constant(m, 0.1);
  Random random{4};

  Eigen::RowVectorXd draw(const Eigen::RowVectorXd& theta) {
    Eigen::RowVectorXd d(m);
    const double shared = random.normal();
    for (Eigen::Index j = 0; j < m; ++j) d[j] = 20 * theta[j % 3] + 0.6 * shared + 0.8 * random.normal();
    return d;
  }
  World() {
    for (Eigen::Index i = 0; i < parameters.rows(); ++i) {
      for (double& u : parameters.row(i)) u = random.uniform();
      descriptors.row(i) = draw(parameters.row(i));
    }
  }
};

TEST(NoiseMetric, another_seed_of_the_same_tree_is_at_distance_one) {
  World world;
  const Eigen::RowVectorXd theta = Eigen::RowVectorXd::Constant(3, 0.5);
  for (const int seeds : {1, 4}) {
    double sum = 0;
    for (int k = 0; k < 100; ++k) {
      const NoiseMetric metric(world.parameters, world.descriptors, world.draw(theta).transpose(),
                               world.error);
      Eigen::MatrixXd simulations(seeds, world.m);
      for (int s = 0; s < seeds; ++s) simulations.row(s) = world.draw(theta);
      sum += metric.cost(simulations);
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
  const NoiseMetric metric(world.parameters, world.descriptors, world.draw(here).transpose(), world.error);
  EXPECT_GT(metric.cost(world.draw(there)), 2 * metric.cost(world.draw(here)));
}

TEST(NoiseMetric, descriptors_that_the_tree_lacks_are_not_used_and_those_a_simulation_lacks_cost) {
  World world;
  Eigen::VectorXd observed = world.draw(Eigen::RowVectorXd::Constant(3, 0.5)).transpose();
  observed[2] = kNone;
  const NoiseMetric metric(world.parameters, world.descriptors, observed, world.error);
  EXPECT_EQ(static_cast<Eigen::Index>(metric.used().size()), world.m - 1);
  EXPECT_TRUE(std::isnan(metric.noise(2)));
  Eigen::RowVectorXd simulation = observed.transpose();
  const double near = metric.cost(simulation);
  simulation[5] = kNone;
  EXPECT_NEAR(metric.cost(simulation) - near, 9.0 / double(world.m - 1), 1e-9);
}

TEST(NoiseMetric, nothing_in_common_is_said) {
  World world;
  EXPECT_THROW(NoiseMetric(world.parameters, world.descriptors, Eigen::VectorXd::Constant(world.m, kNone),
                           world.error),
               SolverError);
}

}  // namespace
}  // namespace dendrofit
