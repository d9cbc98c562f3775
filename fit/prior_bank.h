// SPDX-License-Identifier: GPL-3.0-or-later
// Simulations drawn from the prior once and kept, so that a fit starts with what they say: parameter sets and
// the descriptors of the trees they grow.
#pragma once

#include "fit/seed_noise.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// Parameter set number `index` of the prior; independent of how many are drawn. Half of the draws grow by
/// the logistic equation, a quarter each by Bertalanffy's and Weibull's.
struct PriorDraw {
  std::string equation;
  Eigen::VectorXd unit;  ///< in the box of SearchSpace(equation)
  std::uint64_t seed = 0;
};
PriorDraw prior_draw(std::uint64_t index);
/// The share of draws that grow by `equation`.
double prior_share(const std::string& equation);

/// Descriptors of the draw's tree, describe_at_all_levels() with the drawn tip radius. `replicate` above 0:
/// of another tree of the same parameters.
std::vector<double> simulate_draw(std::uint64_t index, std::uint64_t replicate = 0);

/// Typical noise between seeds at each truncation of kVisibleShares, from replicates of the first draws of
/// `bank` whose trees are of a usual size. The same for any number of threads.
std::vector<SeedNoise> measure_seed_noise(const Eigen::MatrixXf& draws, int threads);

/// One draw a row, from draw 0 on; NaN where a tree lacks something.
struct PriorBank {
  Eigen::MatrixXf descriptors;
  std::vector<float> stamp;      ///< model_stamp() of the model that grew them
  std::vector<SeedNoise> noise;  ///< measure_seed_noise(), one per truncation

  std::size_t size() const { return static_cast<std::size_t>(descriptors.rows()); }
};

/// How the growth model and the descriptors behave: the descriptors of a few small trees, preceded by a
/// digest of the tables of searched coordinates and descriptors. A bank whose stamp differs belongs to
/// another model.
std::vector<float> model_stamp();

/// Why `bank` must not be used with the model as it is now; nothing where it may.
std::optional<std::string> why_stale(const PriorBank& bank);

/// As a file: 16 bits a value, columns apart, deflated. The same bank gives the same bytes.
std::string encode_bank(const PriorBank& bank);
/// The reverse, to 1/65534 of each column's range. Throws IoError, led by `name`, for anything else.
PriorBank decode_bank(std::string_view bytes, const std::string& name);

}  // namespace dendrofit
