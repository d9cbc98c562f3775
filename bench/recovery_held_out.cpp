// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recovery_held_out.h"

#include "core/random.h"
#include "fit/descriptors.h"
#include "fit/regression_posterior.h"
#include "fit/search_space.h"

#include <cmath>

namespace dendrofit {

std::vector<HeldOut> held_out_posteriors(const PriorBank& bank, int truths, std::size_t level,
                                         double errors) {
  const auto kept = static_cast<Eigen::Index>(bank.size()) - truths;
  const auto columns = static_cast<Eigen::Index>(descriptor_table().size());
  const Eigen::MatrixXd all =
      bank.descriptors.middleCols(static_cast<Eigen::Index>(level) * columns, columns).cast<double>();
  const SearchSpace space("logistic");
  PriorSimulations simulations{
      Eigen::MatrixXd(kept, space.size()), all.topRows(kept), Eigen::MatrixXd(kept, 0), {}};
  for (Eigen::Index i = 0; i < kept; ++i)
    simulations.unit.row(i) = prior_draw(static_cast<std::uint64_t>(i)).unit.transpose();
  std::vector<HeldOut> lines;
  for (Eigen::Index t = kept; t < all.rows(); ++t) {
    const double internodes = std::exp(all(t, 0));
    if (internodes < 40 || internodes > 110) continue;
    Observation observed{all.row(t).transpose(), Eigen::VectorXd(columns), Eigen::VectorXd(0)};
    Random random = Random(99).child({static_cast<std::uint64_t>(t)});
    for (Eigen::Index j = 0; j < columns; ++j) {
      observed.error[j] = errors * descriptor_table()[static_cast<std::size_t>(j)].scan_error;
      observed.descriptors[j] += observed.error[j] * random.normal();
    }
    const PosteriorSample posterior = regression_posterior(simulations, observed);
    const Eigen::VectorXd truth = prior_draw(static_cast<std::uint64_t>(t)).unit;
    for (Eigen::Index k = 0; k < space.size(); ++k) {
      const Eigen::VectorXd values = posterior.unit.col(k);
      const auto at = [&](double share) { return weighted_quantile(values, posterior.weights, share); };
      HeldOut line{static_cast<int>(t),
                   std::string(space.rows()[static_cast<std::size_t>(k)].key),
                   truth[k],
                   at(0.5),
                   at(0.05),
                   at(0.95),
                   at(0.25),
                   at(0.75)};
      line.shrinkage = 1 - std::sqrt(12.0) * weighted_deviation(values, posterior.weights);
      for (Eigen::Index i = 0; i < values.size(); ++i)
        if (values[i] < truth[k]) line.rank += posterior.weights[i];
      lines.push_back(line);
    }
  }
  return lines;
}

}  // namespace dendrofit
