// SPDX-License-Identifier: GPL-3.0-or-later
// A tree analysed once for all its descriptors.
#pragma once

#include "core/tree.h"
#include "core/tree_topology.h"
#include "fit/descriptors.h"

#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace dendrofit {

struct DescriptorInput {
  Tree tree;  ///< comparable_tree
  std::vector<Axis> axes;
  Vec3 foot = Vec3::Zero();
  double height = 0;  ///< of the whole tree: a scan sees the top even where its twigs are too thin to compare
  double internode_length = 0.1;
  double total_volume = 0;
  double total_length = 0;
  double length_centroid = 0;  ///< height of the wood length's centroid above the foot
  double spread = 0;           ///< mean horizontal distance of the wood's length from the foot
  std::vector<std::pair<double, double>> volume_by_height;  ///< (height of a piece's middle, volume), rising
  std::vector<Vec3> samples;  ///< points every 1/200 of the height along the wood, foot at the origin
  double base_diameter = 0;   ///< of the stem at a tenth of the height
  std::vector<double> fork_exponents;  ///< of forks whose radii are measured, rising
  std::vector<double> path_lengths;    ///< from the foot to each tip, rising
};

/// Throws InputError for an empty tree.
DescriptorInput analyse(const Tree& tree, const DescribeOptions& options);

/// Whether `axis` is a branch of this order (a stem is none).
bool is_branch(const Axis& axis, int order);
/// Number of branches of this order.
int branch_count(const DescriptorInput& in, int order);
/// value(axis) of each branch of this order, rising.
std::vector<double> over_branches(const DescriptorInput& in, int order,
                                  const std::function<double(const Axis&)>& value);

/// Angle at which an axis leaves its parent, over its first quarter, degrees.
double insertion_angle(const DescriptorInput& in, const Axis& axis);
/// Elevation above the horizontal of an axis' piece between two shares of its length, degrees.
double elevation(const DescriptorInput& in, const Axis& axis, double from, double to);
/// Radius at the axis' base over its parent's there.
double radius_ratio(const DescriptorInput& in, const Axis& axis);
/// Chord over length, of the axis resampled every fortieth of the tree's height.
double straightness(const DescriptorInput& in, const Axis& axis);
/// Height of the axis' base over the tree's.
double base_height(const DescriptorInput& in, const Axis& axis);

/// v with sum(child^v) = parent^v of every fork with measured radii, in [1.2, 5] (none where a child is
/// thicker than its parent), rising.
std::vector<double> fork_exponents(const Tree& tree);

}  // namespace dendrofit
