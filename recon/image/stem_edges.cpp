// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/stem_edges.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr int kRowsEvened = 3;       // to either side: texture of bark and grass
constexpr float kScatters = 4;       // of the background's own spread that a pixel must be off it
constexpr float kLeastOff = 6;       // grey levels
constexpr float kBend = 0.5F;        // price of an edge's step to the next column, in pixels' votes
constexpr std::size_t kSteps = 2;    // columns an edge may move from row to row
constexpr float kStandsOut = 0.25F;  // mean vote of a side's inner half: it differs from what is beside
constexpr double kNarrowest = 0.35;  // of the usual width: rows of a stem are not thinner

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

struct StemSurroundings::Beside {
  Colour colour = Colour::Zero();
  float limit = -1;  ///< how far off it a pixel must be; negative: nothing is known
};

StemSurroundings::StemSurroundings(const Photograph& photo, int left, int right, int top, int bottom)
    : left_(std::max(0, left)),
      right_(std::min(photo.width, right)),
      top_(std::max(0, top)),
      bottom_(std::min(photo.height, bottom)) {
  const int width = std::max(0, right_ - left_);
  evened_.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(std::max(0, bottom_ - top_)));
  for (int y = top_; y < bottom_; ++y) {
    const int first = std::max(top_, y - kRowsEvened), last = std::min(bottom_ - 1, y + kRowsEvened);
    for (int x = left_; x < right_; ++x) {
      Colour sum = Colour::Zero();
      for (int row = first; row <= last; ++row)
        for (std::size_t k = 0; k < 3; ++k)
          sum[static_cast<Eigen::Index>(k)] += static_cast<float>(photo.rgb[3 * photo.pixel(x, row) + k]);
      evened_.push_back(sum / static_cast<float>(last - first + 1));
    }
  }
}

const StemSurroundings::Colour& StemSurroundings::at(int column, int row) const {
  return evened_[static_cast<std::size_t>(row - top_) * static_cast<std::size_t>(right_ - left_) +
                 static_cast<std::size_t>(column - left_)];
}

StemSurroundings::Beside StemSurroundings::beside(int row, int middle, int width, int side) const {
  const int near = middle + side * width, far = middle + side * (3 * width + 8);
  const int first = std::max(left_, std::min(near, far)), last = std::min(right_ - 1, std::max(near, far));
  Beside result;
  if (last - first < std::max(5, width / 2)) return result;
  std::vector<float> values;
  for (Eigen::Index k = 0; k < 3; ++k) {
    values.clear();
    for (int x = first; x <= last; ++x) values.push_back(at(x, row)[k]);
    result.colour[k] = median(values);
  }
  values.clear();
  for (int x = first; x <= last; ++x) values.push_back((at(x, row) - result.colour).norm());
  result.limit = std::max(kLeastOff, kScatters * median(values));
  return result;
}

/// What it is worth to let wood end k pixels from the middle: the votes of all pixels up to there. Empty
/// where the side does not differ from what is beside it.
std::vector<float> StemSurroundings::gains(int row, int middle, int width, int side) const {
  const Beside behind = beside(row, middle, width, side);
  if (behind.limit < 0) return {};
  const auto vote = [&](int k) {
    const int x = middle + side * k;
    if (x < left_ || x >= right_) return -1.0F;
    return std::clamp((at(x, row) - behind.colour).norm() / behind.limit - 1, -1.0F, 1.0F);
  };
  const int inner = std::max(2, width / 4), widest_gap = std::max(2, width / 8);
  float within = 0;
  for (int k = 0; k < inner; ++k) within += vote(k) / static_cast<float>(inner);
  if (within < kStandsOut) return {};
  std::vector<float> gain(static_cast<std::size_t>(std::max(4, width)) + 1, 0);
  int gap = 0;
  for (std::size_t k = 1; k < gain.size(); ++k) {
    const float here = vote(static_cast<int>(k) - 1);
    if (gap <= widest_gap) gap = here < 0 ? gap + 1 : 0;
    gain[k] = gain[k - 1] + (gap > widest_gap ? -1 : here);  // beyond a gap begins something else
  }
  return gain;
}

std::optional<StemRow> StemSurroundings::row_of(int row, int middle, int width) const {
  if (row < top_ || row >= bottom_ || middle < left_ || middle >= right_) return std::nullopt;
  const auto l = gains(row, middle, width, -1), r = gains(row, middle, width, 1);
  if (l.empty() || r.empty()) return std::nullopt;
  const auto extent = [](const std::vector<float>& gain) {
    return static_cast<int>(std::max_element(gain.begin(), gain.end()) - gain.begin());
  };
  return StemRow{row, std::max(left_, middle - extent(l) + 1), std::min(right_ - 1, middle + extent(r) - 1)};
}

/// The best connected line through rows of gains: pixels of wood from the middle in each.
std::vector<int> StemSurroundings::edge(const std::vector<std::vector<float>>& gains) const {
  const std::size_t states = gains.front().size();
  std::vector<std::vector<int>> from(gains.size(), std::vector<int>(states, 0));
  std::vector<float> total = gains.front();
  for (std::size_t i = 1; i < gains.size(); ++i) {
    std::vector<float> next(states);
    for (std::size_t k = 0; k < states; ++k) {
      std::size_t best = k;
      float most = total[k];
      for (std::size_t at = k < kSteps ? 0 : k - kSteps; at < std::min(states, k + kSteps + 1); ++at) {
        const float bent = total[at] - kBend * std::abs(static_cast<float>(at) - static_cast<float>(k));
        if (bent > most) most = bent, best = at;
      }
      next[k] = most + gains[i][k];
      from[i][k] = static_cast<int>(best);
    }
    total = std::move(next);
  }
  std::vector<int> line(gains.size());
  auto at = static_cast<int>(std::max_element(total.begin(), total.end()) - total.begin());
  for (std::size_t i = gains.size(); i-- > 0;) {
    line[i] = at;
    at = from[i][static_cast<std::size_t>(at)];
  }
  return line;
}

void StemSurroundings::settle(std::vector<StemRow>& rows) const {
  if (rows.empty()) return;
  std::vector<float> widths;
  widths.reserve(rows.size());
  for (const StemRow& row : rows) widths.push_back(static_cast<float>(row.last - row.first + 1));
  const int width = std::max(3, static_cast<int>(std::lround(median(widths))));
  std::vector<StemRow> settled = rows;
  for (const int side : {-1, 1}) {
    std::vector<std::vector<float>> all;
    std::vector<char> told;
    for (const StemRow& row : rows) {
      all.push_back(gains(row.row, (row.first + row.last) / 2, width, side));
      told.push_back(!all.back().empty());
      if (!told.back()) all.back().assign(static_cast<std::size_t>(std::max(4, width)) + 1, 0);
    }
    const std::vector<int> line = edge(all);
    const auto first = std::find(told.begin(), told.end(), 1) - told.begin();
    const auto end = told.rend() - std::find(told.rbegin(), told.rend(), 1);
    for (auto k = first; k < end; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const int middle = (rows[i].first + rows[i].last) / 2;
      if (side < 0)
        settled[i].first = std::max(left_, middle - line[i] + 1);
      else
        settled[i].last = std::min(right_ - 1, middle + line[i] - 1);
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (settled[i].last - settled[i].first + 1 >= kNarrowest * width) rows[i] = settled[i];
}

}  // namespace dendrofit
