// SPDX-License-Identifier: GPL-3.0-or-later
// check_leaves: does any leaf meet another leaf, the wood or the ground? Reads files, decides exactly.
#include "tests/leaves/exact_check.h"

#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <string>

namespace {

constexpr const char* kUsage =
    "usage: check_leaves LEAVES.obj QSM.csv [--leaves LEAVES.csv] [--petioles PETIOLES.obj] [--shoots "
    "SHOOTS.csv]\n"
    "                    [--ground Z|none]\n"
    "  Looks for leaves that meet another leaf, a cylinder of the tree (solid, flat ends) or the ground; "
    "touching\n"
    "  counts. Decisions are exact. A leaf is what hangs together by shared vertices, or, with --leaves, an "
    "equal\n"
    "  share of the triangles for each row. The ground is level, at the lowest foot of the tree unless "
    "given.\n"
    "  Exit: 0 none found, 1 some found, 2 wrong usage or a file that cannot be read.\n";

void show(const char* what, const std::vector<leafcheck::Hit>& hits, const char* other) {
  std::printf("%s: %zu\n", what, hits.size());
  for (std::size_t i = 0; i < hits.size() && i < 10; ++i)
    std::printf("  leaf %zu and %s %zu\n", hits[i].leaf + 1, other, hits[i].other + 1);
}

}  // namespace

int main(int argc, char** argv) {
  std::optional<std::string> obj, qsm, rows, petioles, shoots, ground;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      std::fputs(kUsage, stdout);
      return 0;
    }
    std::optional<std::string>* const named = word == "--leaves"     ? &rows
                                              : word == "--petioles" ? &petioles
                                              : word == "--shoots"   ? &shoots
                                              : word == "--ground"   ? &ground
                                                                     : nullptr;
    if (named && i + 1 < argc)
      *named = argv[++i];
    else if (!obj)
      obj = word;
    else if (!qsm)
      qsm = word;
    else
      qsm.reset(), obj.reset(), i = argc;
  }
  if (!obj || !qsm || (petioles && !rows)) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  try {
    double level = 0;
    auto wood = leafcheck::read_cylinders(*qsm, &level);
    const bool no_ground = (ground && *ground == "none") || wood.empty();
    if (shoots)
      for (const leafcheck::Cylinder& c : leafcheck::read_cylinders(*shoots)) wood.push_back(c);
    if (ground && *ground != "none") level = std::stod(*ground);
    auto triangles = leafcheck::read_obj(*obj, rows ? leafcheck::count_rows(*rows) : 0);
    if (petioles)
      for (const leafcheck::Triangle& t : leafcheck::read_grouped_obj(*petioles)) triangles.push_back(t);
    const leafcheck::Verdict v = leafcheck::check(triangles, wood, no_ground ? nullptr : &level);
    std::printf("%zu leaves, %zu triangles, %zu cylinders\n", v.leaves, v.triangles, v.cylinders);
    std::printf(
        "looked at %zu pairs of leaf triangles and %zu of leaf and wood, %zu of them in rational numbers\n",
        v.leaf_boxes, v.wood_boxes, v.in_doubt);
    show("leaves that meet another leaf", v.leaf_hits, "leaf");
    show("leaves that meet wood", v.wood_hits, "cylinder");
    std::printf("leaves in the ground: %zu\ntriangles without area: %zu\n", v.ground_hits.size(),
                v.degenerate.size());
    return v.clean() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "check_leaves: %s\n", error.what());
    return 2;
  }
}
