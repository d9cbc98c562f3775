// SPDX-License-Identifier: GPL-3.0-or-later
// Where a stem's two edges run, row by row, before what is beside it.
#pragma once

#include "core/photograph.h"

#include <optional>
#include <vector>

namespace dendrofit {

/// The columns a stem takes in one row, last included.
struct StemRow {
  int row = 0, first = 0, last = 0;
};

/// A part of a photograph in which a stem stands. What lies one to three widths beside the stem's middle
/// tells row by row, on either side, the colour behind it; pixels vote for wood by how far off that they are,
/// against the background's own scatter.
class StemSurroundings {
 public:
  /// Columns `left` to `right` and rows `top` to `bottom` (ends excluded), evened along the columns.
  StemSurroundings(const Photograph& photo, int left, int right, int top, int bottom);

  /// How far a stem of about `width` goes to either side of `middle` in a row; none where it does not differ
  /// from what is beside it.
  std::optional<StemRow> row_of(int row, int middle, int width) const;

  /// Moves the edges of `rows`, which follow one another downwards: each edge is the connected line (dynamic
  /// programming) that leaves most of what differs within and of what does not without, in a corridor of a
  /// width to either side of the middle. Rows between such that differ take the line's edges,
  /// those beyond keep their own.
  void settle(std::vector<StemRow>& rows) const;

 private:
  using Colour = Eigen::Vector3f;
  struct Beside;
  const Colour& at(int column, int row) const;
  Beside beside(int row, int middle, int width, int side) const;
  std::vector<float> gains(int row, int middle, int width, int side) const;
  std::vector<int> edge(const std::vector<std::vector<float>>& gains) const;

  int left_, right_, top_, bottom_;
  std::vector<Colour> evened_;
};

}  // namespace dendrofit
