// SPDX-License-Identifier: GPL-3.0-or-later
// What of a tree a scan can tell and a growth model must match: named numbers, computed the same way for
// both.
#pragma once

#include "core/tree.h"

#include <span>
#include <string_view>
#include <vector>

namespace dendrofit {

struct DescribeOptions {
  double visible_radius_m = 0.005;  ///< thinner wood is dropped first: a scan does not show it reliably
  double shortest_axis_m = 0.3;     ///< shorter axes are dropped next
  void validate() const;
};

/// The tree as both sides see it: wood thinner than the visible radius dropped with all beyond it, axes laid
/// by the thickest child (so that a simulator's own order plays no part), short axes dropped.
Tree comparable_tree(const Tree& tree, const DescribeOptions& options);

/// What a row's function may look at; computed once a tree.
struct DescriptorInput;

/// One named descriptor. Adding one is adding a row to the table in descriptors.cpp.
struct DescriptorRow {
  std::string_view name;
  std::string_view unit;  ///< of the value as returned; "log" for a natural logarithm
  double scan_error;      ///< standard error a scan adds, in the same unit
  std::string_view meaning;
  double (*compute)(const DescriptorInput&);  ///< NaN where the tree has no such thing
};

std::span<const DescriptorRow> descriptor_table();

/// One value per row of the table. Throws InputError for an empty tree; never for a poor one (a bare stem,
/// three cylinders): what it lacks is NaN.
std::vector<double> describe(const Tree& tree, const DescribeOptions& options);

}  // namespace dendrofit
