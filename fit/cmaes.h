// SPDX-License-Identifier: GPL-3.0-or-later
// CMA-ES by ask and tell, so that the caller evaluates a generation in parallel and may stop after any.
#pragma once

#include "core/random.h"

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

struct CmaesOptions {
  double initial_step = 0.2;  ///< of the unit box
  int population = 0;         ///< 0: 4 + floor(3 ln n)
  std::uint64_t seed = 1;
  void validate() const;
};

/// Covariance matrix adaptation evolution strategy (Hansen 2016, "The CMA Evolution Strategy: A Tutorial",
/// (mu/mu_w, lambda) with rank-one and rank-mu update) minimising over the unit box [0,1]^n. Candidates
/// outside are reflected into it. All draws are keyed by (seed, generation, candidate): the run depends on
/// nothing else.
class Cmaes {
 public:
  Cmaes(const Eigen::VectorXd& start, const CmaesOptions& options);

  /// The candidates of the next generation, inside the box.
  const std::vector<Eigen::VectorXd>& ask();
  /// Their costs, in the same order (NaN counts as worst). Ends the generation.
  void tell(const std::vector<double>& costs);

  const Eigen::VectorXd& mean() const { return mean_; }
  double step() const { return step_; }
  int generation() const { return generation_; }
  int population() const { return static_cast<int>(lambda_); }
  /// True when the distribution has shrunk below `tolerance` in every coordinate.
  bool converged(double tolerance) const;

 private:
  void decompose();

  const Eigen::Index n_;
  const std::uint64_t seed_;
  std::size_t lambda_;
  Eigen::VectorXd weights_;
  double mu_eff_ = 0, c_sigma_ = 0, d_sigma_ = 0, c_c_ = 0, c_1_ = 0, c_mu_ = 0, chi_n_ = 0;
  int generation_ = 0;
  double step_;
  Eigen::VectorXd mean_, path_sigma_, path_c_;
  Eigen::MatrixXd covariance_, basis_;
  Eigen::VectorXd axes_;
  std::vector<Eigen::VectorXd> candidates_;
};

}  // namespace dendrofit
