// SPDX-License-Identifier: GPL-3.0-or-later
// Trees whose every cylinder is known, and virtual scans of them: what a reconstruction is measured on.
#pragma once

#include "core/tree.h"
#include "forward/virtual_scan/virtual_scan.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit::bench {

/// One scan to be made: which tree, seen how, with or without leaves.
struct Case {
  std::string name;
  int kind = 0;  ///< 0..2 drawn by make_tree(): broad, slender, bushy; 3 grown by the growth model
  std::uint64_t seed = 1;
  double height_m = 8;  ///< drawn trees
  ScanOptions scan;
  std::optional<std::string> species;  ///< of its leaves; none: leaf-off
  double lai = 2;
};

/// `count` cases that go through kinds, heights (4 to 16 m), stations (1 to 4), beam steps, range noises and,
/// if asked, leaves. Case i is the same whatever `count`.
std::vector<Case> made_cases(int count, bool leaf_on);

/// A tree drawn at random by `seed`: tapering, gently bent axes, branches all along. Nothing of it comes from
/// a growth model.
Tree make_tree(int kind, double height_m, std::uint64_t seed);

/// The tree of a case.
Tree tree_of(const Case& c);

/// The case's scan of its tree.
VirtualScan scan_of(const Case& c, const Tree& tree);

}  // namespace dendrofit::bench
