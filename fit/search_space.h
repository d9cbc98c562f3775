// SPDX-License-Identifier: GPL-3.0-or-later
// Which IGM parameters a fit searches, over which ranges, and what of them the tree itself tells beforehand.
#pragma once

#include "core/tree.h"
#include "forward/igm/parameters.h"

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// What can be read off the observed tree without any simulation.
struct DirectEstimates {
  double internode_length_m = 0.1;  ///< rho: a convention (a scan does not show internodes), see scale_for()
  double pipe_exponent = 2.6;       ///< v of the pipe model from the tree's own forks
  int forks = 0;                    ///< how many forks told it; fewer than 10: the default stands
  std::optional<double> dbh_m;
  double base_radius_m = 0;  ///< of the thickest root
  double height_m = 0;
};

/// The largest internode length of the series 1-2-5 (metres) that gives the tree at least 50 internodes of
/// height.
double scale_for(double height_m);

/// Throws InputError for an empty tree. `internode_length_m`: taken as given instead of scale_for(height).
DirectEstimates estimate_directly(const Tree& tree, std::optional<double> internode_length_m = {});

/// One searched parameter; the prior is uniform between lo and hi.
struct SearchRow {
  std::string key;
  double lo = 0;
  double hi = 0;
};

/// Maps the unit box to parameter sets.
class SearchSpace {
 public:
  /// `cycles`: the tree's age in growth cycles where it is known; it is searched otherwise.
  SearchSpace(const DirectEstimates& direct, const std::string& equation, std::optional<int> cycles);

  const std::vector<SearchRow>& rows() const { return rows_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(rows_.size()); }
  double value(Eigen::Index row, double unit) const;
  IgmParameters at(const Eigen::VectorXd& unit) const;
  /// The same ranges for trees of another internode length.
  SearchSpace rescaled(double internode_length_m) const;

 private:
  IgmParameters base_;
  std::vector<SearchRow> rows_;
};

}  // namespace dendrofit
