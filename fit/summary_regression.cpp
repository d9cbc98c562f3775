// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/summary_regression.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace dendrofit {
namespace {

constexpr double kRowsPerFeature = 6;
constexpr double kLeastVariance = 1e-3;  // of a principal component worth keeping
// Leading components whose products are features: with twice as many, a bank of 20,000 trees tells each
// parameter at most 3 % better, and takes ten times as long.
constexpr Eigen::Index kMostCrossed = 20;
constexpr double kLargestLeverage = 0.95;

/// Features of rows: components, then squares and products of the leading ones, centred and scaled by what
/// the simulations show.
class Features {
 public:
  Features(const Eigen::MatrixXd& inputs) {
    const auto n = static_cast<double>(inputs.rows());
    centre_ = inputs.colwise().mean();
    const Eigen::MatrixXd centred = inputs.rowwise() - centre_;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centred.transpose() * centred / n);
    const Eigen::Index most = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(n / kRowsPerFeature));
    Eigen::Index kept = 0;
    while (kept < std::min(most, inputs.cols()) &&
           solver.eigenvalues()[inputs.cols() - 1 - kept] > kLeastVariance)
      ++kept;
    kept = std::max<Eigen::Index>(kept, 1);
    basis_ = solver.eigenvectors().rightCols(kept).rowwise().reverse();
    for (Eigen::Index k = 0; k < kept; ++k)
      basis_.col(k) /= std::sqrt(std::max(kLeastVariance, solver.eigenvalues()[inputs.cols() - 1 - k]));
    while (crossed_ < std::min(kept, kMostCrossed) && kept + (crossed_ + 1) * (crossed_ + 2) / 2 <= most)
      ++crossed_;
    const Eigen::MatrixXd raw = expand(inputs);
    mean_ = raw.colwise().mean();
    scale_ = ((raw.rowwise() - mean_).array().square().colwise().mean().sqrt()).max(1e-9).matrix();
  }

  Eigen::MatrixXd of(const Eigen::MatrixXd& inputs) const {
    return (expand(inputs).rowwise() - mean_).array().rowwise() / scale_.array();
  }

 private:
  Eigen::MatrixXd expand(const Eigen::MatrixXd& inputs) const {
    const Eigen::MatrixXd scores = (inputs.rowwise() - centre_) * basis_;
    Eigen::MatrixXd all(inputs.rows(), scores.cols() + crossed_ * (crossed_ + 1) / 2);
    all.leftCols(scores.cols()) = scores;
    Eigen::Index at = scores.cols();
    for (Eigen::Index a = 0; a < crossed_; ++a)
      for (Eigen::Index b = a; b < crossed_; ++b) all.col(at++) = scores.col(a).cwiseProduct(scores.col(b));
    return all;
  }

  Eigen::RowVectorXd centre_, mean_, scale_;
  Eigen::MatrixXd basis_;
  Eigen::Index crossed_ = 0;
};

}  // namespace

SummaryRegression::SummaryRegression(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                                     const Eigen::VectorXd& observed) {
  const auto n = static_cast<double>(inputs.rows());
  const Features features(inputs);
  const Eigen::MatrixXd x = features.of(inputs);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(x.transpose() * x / n);
  const Eigen::VectorXd variance = solver.eigenvalues().cwiseMax(0);
  const Eigen::MatrixXd scores = x * solver.eigenvectors();
  const Eigen::VectorXd point = (features.of(observed.transpose()) * solver.eigenvectors()).transpose();
  const Eigen::MatrixXd squares = scores.cwiseAbs2();

  const Eigen::RowVectorXd mean = targets.colwise().mean();
  const Eigen::MatrixXd centred = targets.rowwise() - mean;
  const Eigen::MatrixXd moments = scores.transpose() * centred / n;
  fitted.resize(targets.rows(), targets.cols());
  predicted.resize(targets.cols());
  error = Eigen::VectorXd::Constant(targets.cols(), HUGE_VAL);
  for (double strength = 1e-4; strength < 1e3; strength *= 4) {
    const Eigen::VectorXd inverse = (variance.array() + strength).inverse();
    const Eigen::MatrixXd slopes = inverse.asDiagonal() * moments;
    const Eigen::ArrayXd leverage = (1 + (squares * inverse).array()) / n;
    const Eigen::ArrayXd keep = 1 / (1 - leverage.min(kLargestLeverage));
    const Eigen::MatrixXd left_out = ((centred - scores * slopes).array().colwise() * keep).matrix();
    for (Eigen::Index j = 0; j < targets.cols(); ++j) {
      const double rms = std::sqrt(left_out.col(j).squaredNorm() / n);
      if (rms >= error[j]) continue;
      error[j] = rms;
      fitted.col(j) = targets.col(j) - left_out.col(j);
      predicted[j] = mean[j] + point.dot(slopes.col(j));
    }
  }
}

}  // namespace dendrofit
