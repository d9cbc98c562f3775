// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/ground.h"

#include "recon/image/stem_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

namespace dendrofit {
namespace {

constexpr double kLeastContrast = 8;       ///< grey levels: a stem's colour differs from the ground's by more
constexpr double kLeastSeen = 1.0 / 3;     ///< of a stem's rows; more carried on is a guess
constexpr double kOfUsualContrast = 0.35;  ///< and by more than this share of what most of its rows do

/// The strip at half size, and where it lies.
struct Strip {
  cv::Mat bgr;
  int left, top;  ///< full-size pixel of its corner
};

Strip cut_strip(const Photograph& photo, int left, int right, int top) {
  const cv::Mat whole(photo.height, photo.width, CV_8UC3, const_cast<std::uint8_t*>(photo.rgb.data()));
  cv::Mat half;
  const cv::Rect area(left, top, right - left, photo.height - top);
  cv::resize(whole(area), half, cv::Size(std::max(1, area.width / 2), std::max(1, area.height / 2)), 0, 0,
             cv::INTER_AREA);
  return {half, left, top};
}

using Colour = Eigen::Vector3d;

Colour mean_colour(const Photograph& photo, int row, int first, int last) {
  Colour sum = Colour::Zero();
  for (int x = first; x <= last; ++x)
    for (int c = 0; c < 3; ++c) sum[c] += photo.rgb[3 * photo.pixel(x, row) + static_cast<std::size_t>(c)];
  return sum / std::max(1, last - first + 1);
}

/// How far beyond `edge` (the last wood column in direction `side`) the colour is half-way between the wood's
/// and the background's; none where these hardly differ.
std::optional<double> edge_shift(const Photograph& photo, int row, int middle, int edge, int side) {
  constexpr int reach = 4;
  const int width = std::abs(edge - middle);
  const int out_near = edge + side * (reach + 1), out_far = edge + side * (reach + 6);
  if (width < 4 || std::min(out_near, out_far) < 0 || std::max(out_near, out_far) >= photo.width)
    return std::nullopt;
  const int in_edge = edge - side * std::min(reach + 1, width - 1);
  const Colour wood = mean_colour(photo, row, std::min(middle, in_edge), std::max(middle, in_edge));
  const Colour ground = mean_colour(photo, row, std::min(out_near, out_far), std::max(out_near, out_far));
  const Colour axis = wood - ground;
  if (axis.norm() < 12) return std::nullopt;
  // Wood in the window about the edge, as a sum of shares: bark's own pattern averages out.
  double covered = 0;
  for (int k = -reach; k <= reach; ++k) {
    const Colour here = mean_colour(photo, row, edge + side * k, edge + side * k);
    covered += std::clamp((here - ground).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  }
  return covered - (reach + 1);
}

/// Median over the rows within `reach` of each.
std::vector<double> running_median(const std::vector<double>& values, std::size_t reach) {
  std::vector<double> smooth(values.size()), window;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(i >= reach ? i - reach : 0);
    const auto last = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), i + reach + 1));
    window.assign(first, last);
    auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
    std::nth_element(window.begin(), middle, window.end());
    smooth[i] = *middle;
  }
  return smooth;
}

/// Edges without the jumps of single rows (a twig before or behind, a row that was misread).
void straighten(std::vector<StemRow>& rows) {
  constexpr std::size_t reach = 7;
  std::vector<double> first, last;
  for (const StemRow& row : rows) first.push_back(row.first), last.push_back(row.last);
  first = running_median(first, reach);
  last = running_median(last, reach);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].first = static_cast<int>(first[i]);
    rows[i].last = static_cast<int>(last[i]);
  }
}

/// Mean colour of the middle half of a row of the stem.
Colour bark_of(const Photograph& photo, const StemRow& row) {
  const int quarter = (row.last - row.first + 1) / 4;
  return mean_colour(photo, row.row, row.first + quarter, row.last - quarter);
}

/// How much a row of the stem differs in colour from what is beside it, on the side where it differs less.
double standing_out(const Photograph& photo, const StemRow& row) {
  const int width = std::max(4, row.last - row.first + 1), gap = std::max(2, width / 6);
  const Colour wood = bark_of(photo, row);
  double least = 1e9;
  for (const int side : {-1, 1}) {
    const int near = (side < 0 ? row.first : row.last) + side * gap, far = near + side * (width + 4);
    if (std::min(near, far) < 0 || std::max(near, far) >= photo.width) continue;
    least = std::min(least,
                     (wood - mean_colour(photo, row.row, std::min(near, far), std::max(near, far))).norm());
  }
  return least;
}

/// Drops the last rows, as far as they do not stand out: the stem has ended above them.
void drop_beyond_foot(const Photograph& photo, std::vector<StemRow>& rows) {
  if (rows.empty()) return;
  std::vector<double> contrast;
  contrast.reserve(rows.size());
  for (const StemRow& row : rows) contrast.push_back(standing_out(photo, row));
  contrast = running_median(contrast, 7);
  std::vector<double> sorted = contrast;
  const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(3 * sorted.size() / 4);
  std::nth_element(sorted.begin(), high, sorted.end());
  const double least = std::max(kLeastContrast, kOfUsualContrast * *high);
  while (!rows.empty() && contrast[rows.size() - 1] < least) rows.pop_back();
}

/// Writes the rows into `tree`, their edges moved to where the colour changes (GrabCut's are good to a pixel
/// of its half-size picture).
void write_rows(const Photograph& photo, const std::vector<StemRow>& rows, std::vector<std::uint8_t>& tree) {
  std::vector<double> left(rows.size(), 0), right(rows.size(), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int middle = (rows[i].first + rows[i].last) / 2;
    left[i] = edge_shift(photo, rows[i].row, middle, rows[i].first, -1).value_or(0);
    right[i] = edge_shift(photo, rows[i].row, middle, rows[i].last, 1).value_or(0);
  }
  left = running_median(left, 7);
  right = running_median(right, 7);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int first = std::max(0, rows[i].first - static_cast<int>(std::lround(left[i])));
    const int last = std::min(photo.width - 1, rows[i].last + static_cast<int>(std::lround(right[i])));
    for (int x = first; x <= last; ++x) tree[photo.pixel(x, rows[i].row)] = 1;
  }
}

}  // namespace

int follow_stem_down(const Photograph& photo, const StemCrossing& stem, std::vector<std::uint8_t>& tree) {
  const int width = stem.last - stem.first + 1;
  const double middle = 0.5 * (stem.first + stem.last);
  const int side = std::max(4 * width, 40);
  const double end = middle + stem.slope * (photo.height - stem.row);
  const int left = std::max(0, static_cast<int>(std::min(middle, end)) - side);
  const int right = std::min(photo.width, static_cast<int>(std::max(middle, end)) + side);
  const int top = std::max(0, stem.row - 4 * width);
  if (right - left < 8 || photo.height - stem.row < 8) return stem.row;
  const Strip strip = cut_strip(photo, left, right, top);

  cv::Mat label(strip.bgr.rows, strip.bgr.cols, CV_8U, cv::Scalar(cv::GC_BGD));
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x) {
      const int row = strip.top + 2 * y, column = std::min(photo.width - 1, strip.left + 2 * x);
      const double from_axis = std::abs(column - (middle + stem.slope * (row - stem.row)));
      std::uint8_t& l = label.at<std::uint8_t>(y, x);
      if (row <= stem.row) {
        l = tree[photo.pixel(column, row)] ? cv::GC_FGD : cv::GC_BGD;
      } else if (row - stem.row < width && from_axis < 0.2 * width) {
        l = cv::GC_FGD;
      } else if (from_axis < 0.45 * width) {
        l = cv::GC_PR_FGD;
      } else if (from_axis < 2.5 * width + 0.15 * (row - stem.row)) {
        l = cv::GC_PR_BGD;
      }
    }
  // GrabCut starts its colour clusters from OpenCV's generator of this thread: the same each time.
  cv::theRNG().state = 0x5eed;
  cv::Mat background, foreground;
  cv::grabCut(strip.bgr, label, cv::Rect(), background, foreground, 4, cv::GC_INIT_WITH_MASK);

  const auto is_wood = [&](int column, int row) {
    const int x = (column - strip.left) / 2, y = (row - strip.top) / 2;
    if (x < 0 || y < 0 || x >= label.cols || y >= label.rows) return false;
    const std::uint8_t l = label.at<std::uint8_t>(y, x);
    return l == cv::GC_FGD || l == cv::GC_PR_FGD;
  };
  const StemSurroundings surroundings(photo, left, right, stem.row - 8, photo.height);
  // Row by row: what differs from what is beside the stem, or else GrabCut's run of wood, over where the rows
  // above lead; it must be nearer to the bark above than to what is beside it. Where what is behind looks
  // like bark, rows are carried on as the stem comes down, until it stands out again.
  double usual = width, at = middle, lean = stem.slope;
  const int patience = std::max(8 * width, photo.height / 20);
  int foot = stem.row;
  std::size_t seen_rows = 0;
  Colour bark = bark_of(photo, {stem.row, stem.first, stem.last});
  std::vector<StemRow> rows;
  for (int row = stem.row + 1; row < photo.height && row - foot <= patience; ++row) {
    at += lean;
    int best_first = 0, best_last = -1;
    for (int x = std::max(left, static_cast<int>(at - 0.75 * usual));
         x <= std::min(right - 1, static_cast<int>(at + 0.75 * usual)); ++x) {
      if (!is_wood(x, row)) continue;
      int from = x, to = x;
      while (to + 1 < right && is_wood(to + 1, row)) ++to;
      while (from > left && is_wood(from - 1, row)) --from;
      if (to - from > best_last - best_first) best_first = from, best_last = to;
      x = to;
    }
    const auto seen =
        surroundings.row_of(row, static_cast<int>(std::lround(at)), static_cast<int>(std::lround(usual)));
    if (seen && standing_out(photo, *seen) > (bark_of(photo, *seen) - bark).norm())
      best_first = seen->first, best_last = seen->last;
    const double run = best_last - best_first + 1, centre = 0.5 * (best_first + best_last);
    if (run > 0.5 * usual && run < 1.6 * usual + 2 && std::abs(centre - at) < 0.5 * usual + 1) {
      lean += 0.01 * (centre - at);
      at += 0.3 * (centre - at);
      usual += 0.05 * (run - usual);
      rows.push_back({row, best_first, best_last});
      ++seen_rows;
      bark += 0.05 * (bark_of(photo, rows.back()) - bark);
      foot = row;
    } else {
      const int first = static_cast<int>(std::lround(at - 0.5 * (usual - 1)));
      rows.push_back(
          {row, std::max(0, first), std::min(photo.width - 1, first + static_cast<int>(usual) - 1)});
    }
  }
  while (!rows.empty() && rows.back().row > foot) rows.pop_back();
  if (static_cast<double>(seen_rows) < kLeastSeen * static_cast<double>(rows.size())) return stem.row;
  surroundings.settle(rows);
  straighten(rows);
  drop_beyond_foot(photo, rows);
  write_rows(photo, rows, tree);
  return rows.empty() ? stem.row : rows.back().row;
}

}  // namespace dendrofit
