// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/shed.h"

namespace dendrofit::igm {

std::vector<char> shed_axes(Stand& stand, int passes, std::vector<std::int64_t>& shed) {
  const std::size_t n = stand.axes.size();
  std::vector<char> dropped(n, 0), starved(n, 0);
  std::vector<std::int32_t> laterals(n, 0);
  for (std::size_t axis = 0; axis < n; ++axis) {
    double light = 0;
    const auto nodes = stand.nodes_of(axis);
    for (const std::int32_t node : nodes) {
      light += stand.light(static_cast<std::size_t>(node));
      laterals[axis] += stand.nodes.laterals[static_cast<std::size_t>(node)];
    }
    starved[axis] = stand.axes.order[axis] > 1 &&
                    light < stand.parameters_of_axis(axis).shed_ratio * static_cast<double>(nodes.size());
  }
  for (int pass = 0; pass < passes; ++pass) {
    bool any = false;
    // Bearers come first, so an axis freed of its laterals in this pass waits for the next.
    for (std::size_t axis = 0; axis < n; ++axis) {
      if (dropped[axis] || !starved[axis] || laterals[axis] > 0) continue;
      dropped[axis] = 1;
      any = true;
      const auto base = static_cast<std::size_t>(stand.axes.base[axis]);
      --stand.nodes.laterals[base];
      --laterals[static_cast<std::size_t>(stand.nodes.axis[base])];
      shed[static_cast<std::size_t>(stand.tree_of_axis(axis))] +=
          static_cast<std::int64_t>(stand.nodes_of(axis).size());
    }
    if (!any) break;
  }
  return dropped;
}

}  // namespace dendrofit::igm
