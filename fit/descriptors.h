// SPDX-License-Identifier: GPL-3.0-or-later
// What of a tree a scan can tell and a growth model must match: named numbers, computed the same way for
// both, and free of scale (heights, lengths and radii as shares of the tree's own), so that one bank of
// simulations serves trees of every size.
#pragma once

#include "core/tree.h"

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace dendrofit {

/// How the observed tree came about: decides which descriptors count and what error they carry.
enum class ObservedFrom {
  scan,      ///< reconstructed from a scan seen from several sides
  one_view,  ///< reconstructed from a single photograph: what depth would tell is left out
  exact      ///< a tree known without error (grown, or measured by hand)
};

struct DescribeOptions {
  /// Wood thinner than this share of the stem's radius at a tenth of the height is dropped first.
  double visible_share = 0.14;
  double shortest_axis_share = 0.03;  ///< axes shorter than this share of the height are dropped next
  double internode_length_m = 0.1;    ///< in which the height is counted
  void validate() const;
};

/// The truncations a bank of simulations is made for, fine to coarse.
inline constexpr std::array<double, 2> kVisibleShares = {0.07, 0.14};

/// Radius of the stem at a tenth of the height (of the thickest root where the stem does not tell), metres.
double reference_radius(const Tree& tree);

/// The finest of kVisibleShares at which the thinnest wood compared is thick enough for the way the tree was
/// observed (radius 4 mm in a scan, 8 mm in a photograph), else the coarsest; its index.
std::size_t comparison_level(const Tree& tree, ObservedFrom from);

/// The tree as both sides see it: axes laid by the thickest child (so that a simulator's own order plays no
/// part), wood thinner than the visible share dropped with all beyond it, short axes dropped.
Tree comparable_tree(const Tree& tree, const DescribeOptions& options);

/// The tree without wood whose radius is below `radius_m`, and all beyond it; roots stay.
Tree without_thin_wood(const Tree& tree, double radius_m);

/// What a row's function may look at; computed once a tree.
struct DescriptorInput;

/// One named descriptor. Adding one is adding a row to the table in descriptors.cpp.
struct DescriptorRow {
  std::string_view name;
  std::string_view unit;  ///< of the value as returned; "log" for a natural logarithm
  double scan_error;      ///< standard error a scan and its reconstruction add, in the same unit
  bool one_view;          ///< whether a single view of the tree can tell it
  std::string_view meaning;
  double (*compute)(const DescriptorInput&);  ///< NaN where the tree has no such thing
};

std::span<const DescriptorRow> descriptor_table();

/// Row of that name; throws InputError for another.
std::size_t descriptor_row(std::string_view name);

/// One value per row of the table. Throws InputError for an empty tree; never for a poor one (a bare stem,
/// three cylinders): what it lacks is NaN.
std::vector<double> describe(const Tree& tree, const DescribeOptions& options);

/// The same at every truncation of kVisibleShares, one after the other (`visible_share` is not looked at).
std::vector<double> describe_at_all_levels(const Tree& tree, const DescribeOptions& options);

}  // namespace dendrofit
