// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace dendrofit {
namespace {

using Coefficients = Eigen::Matrix<double, 6, 1>;

Coefficients terms(double x, double y) {
  Coefficients t;
  t << 1, x, y, x * x, x * y, y * y;
  return t;
}

/// Blue of a photograph and the quadratic that describes its sky (coordinates over the picture's size).
struct Sky {
  const Photograph& photo;
  Coefficients fit = Coefficients::Zero();

  double blue(int x, int y) const { return photo.rgb[3 * photo.pixel(x, y) + 2]; }
  double value(int x, int y) const {
    const double v =
        fit.dot(terms(static_cast<double>(x) / photo.width, static_cast<double>(y) / photo.height));
    return std::max(v, 1.0);
  }
};

constexpr float kSkyFrom = 0.92F, kSkyTo = 1.25F;  ///< ratios of sky
constexpr double kLike = 0.08;                     ///< sky is within this share of its fit

/// Least squares on a grid of samples above `bottom`, whatever is darker (trees) or brighter (sun) than the
/// fit dropped round by round.
Coefficients fit_rows(const Sky& sky, int bottom, bool fresh) {
  const int step = std::max(1, std::min(sky.photo.width, bottom) / 120);
  struct Sample {
    Coefficients t;
    double blue;
  };
  std::vector<Sample> samples;
  std::vector<double> all;
  for (int y = step / 2; y < bottom; y += step)
    for (int x = step / 2; x < sky.photo.width; x += step) {
      samples.push_back(
          {terms(static_cast<double>(x) / sky.photo.width, static_cast<double>(y) / sky.photo.height),
           sky.blue(x, y)});
      all.push_back(samples.back().blue);
    }
  Coefficients fit = sky.fit;
  if (fresh) {
    std::nth_element(all.begin(),
                     all.begin() + static_cast<std::ptrdiff_t>(0.6 * static_cast<double>(all.size())),
                     all.end());
    fit = Coefficients::Zero();
    fit[0] = all[static_cast<std::size_t>(0.6 * static_cast<double>(all.size()))];
  }
  for (int round = 0; round < 8; ++round) {
    const double tolerance = fresh && round < 3 ? 0.3 - 0.07 * round : kLike;
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Identity() * 1e-3;
    Coefficients right = normal * fit;
    int used = 0;
    for (const Sample& s : samples) {
      const double expected = std::max(1.0, fit.dot(s.t));
      if (std::abs(s.blue / expected - 1) > tolerance) continue;
      normal += s.t * s.t.transpose();
      right += s.t * s.blue;
      ++used;
    }
    if (used < 30) break;
    fit = normal.ldlt().solve(right);
  }
  return fit;
}

double share_like(const Sky& sky, int top, int bottom) {
  const int step = std::max(1, sky.photo.width / 200);
  int like = 0, all = 0;
  for (int y = top; y < bottom; y += std::max(1, step / 2))
    for (int x = 0; x < sky.photo.width; x += step, ++all)
      like += std::abs(sky.blue(x, y) / sky.value(x, y) - 1) < kLike;
  return all > 0 ? static_cast<double>(like) / all : 0;
}

/// Medians of blue over the fit, where it is sky, on a coarse grid; smoothed, gaps filled from around.
class Unevenness {
 public:
  Unevenness(const Sky& sky, int bottom) : cell_(std::max(8, sky.photo.width / 40)) {
    columns_ = sky.photo.width / cell_ + 2;
    rows_ = sky.photo.height / cell_ + 2;
    std::vector<double> sum(size(), 0), weight(size(), 0);
    std::vector<float> values;
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c) {
        values.clear();
        for (int y = r * cell_; y < std::min({(r + 1) * cell_, bottom, sky.photo.height}); y += 2)
          for (int x = c * cell_; x < std::min((c + 1) * cell_, sky.photo.width); x += 2) {
            const double q = sky.blue(x, y) / sky.value(x, y);
            if (std::abs(q - 1) < 1.5 * kLike) values.push_back(static_cast<float>(q));
          }
        if (values.size() < 10) continue;
        auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        sum[index(c, r)] = *middle * static_cast<double>(values.size());
        weight[index(c, r)] = static_cast<double>(values.size());
      }
    factor_.assign(size(), 1);
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c) factor_[index(c, r)] = mean_around(sum, weight, c, r);
  }
  double at(int x, int y) const {
    const double u = std::max(0.0, static_cast<double>(x) / cell_ - 0.5);
    const double v = std::max(0.0, static_cast<double>(y) / cell_ - 0.5);
    const int c = std::min(static_cast<int>(u), columns_ - 2), r = std::min(static_cast<int>(v), rows_ - 2);
    const double fu = u - c, fv = v - r;
    return (1 - fv) * ((1 - fu) * factor_[index(c, r)] + fu * factor_[index(c + 1, r)]) +
           fv * ((1 - fu) * factor_[index(c, r + 1)] + fu * factor_[index(c + 1, r + 1)]);
  }

 private:
  std::size_t size() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }
  std::size_t index(int c, int r) const {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
  }
  double mean_around(const std::vector<double>& sum, const std::vector<double>& weight, int c, int r) const {
    for (int reach = 1; reach <= 4; ++reach) {
      double s = 0, w = 0;
      for (int y = std::max(0, r - reach); y <= std::min(rows_ - 1, r + reach); ++y)
        for (int x = std::max(0, c - reach); x <= std::min(columns_ - 1, c + reach); ++x) {
          s += sum[index(x, y)];
          w += weight[index(x, y)];
        }
      if (w > 50) return s / w;
    }
    return 1;
  }
  int cell_, columns_ = 0, rows_ = 0;
  std::vector<double> factor_;
};

/// Marks the sky that hangs together with the top row.
void flood_from_top(SkyRatio& s, int bottom) {
  std::vector<std::array<int, 2>> stack;
  const auto visit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= s.width || y >= bottom) return;
    const std::size_t p =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width) + static_cast<std::size_t>(x);
    if (s.sky[p] || s.ratio[p] < kSkyFrom || s.ratio[p] > kSkyTo) return;
    s.sky[p] = 1;
    stack.push_back({x, y});
  };
  for (int x = 0; x < s.width; ++x)
    for (int y = 0; y < std::min(s.height, 1 + s.height / 50); ++y) visit(x, y);
  while (!stack.empty()) {
    const auto [x, y] = stack.back();
    stack.pop_back();
    visit(x + 1, y);
    visit(x - 1, y);
    visit(x, y + 1);
    visit(x, y - 1);
  }
}

/// Row of a straight horizon at a column.
struct Line {
  double at_left = 0, slope = 0;
  double row(int x) const { return at_left + slope * x; }
};

/// The line, of those through two columns' lowest sky, that most columns lie on (within 1.5 % of the height);
/// of equal ones the lower.
Line horizon_line(const std::vector<int>& lowest, int height) {
  const int width = static_cast<int>(lowest.size()), step = std::max(1, width / 60);
  const double near = 0.015 * height;
  Line best;
  double best_score = -1;
  for (int a = step / 2; a < width; a += step)
    for (int b = a + width / 4; b < width; b += step) {
      Line line;
      line.slope =
          static_cast<double>(lowest[static_cast<std::size_t>(b)] - lowest[static_cast<std::size_t>(a)]) /
          (b - a);
      if (std::abs(line.slope) > 0.15) continue;
      line.at_left = lowest[static_cast<std::size_t>(a)] - line.slope * a;
      double score = 1e-6 * line.row(width / 2);
      for (int x = 0; x < width; x += step)
        score += std::abs(lowest[static_cast<std::size_t>(x)] - line.row(x)) < near;
      if (score > best_score) {
        best_score = score;
        best = line;
      }
    }
  if (best_score < 0) best.at_left = height;
  return best;
}

/// The lowest sky of each column; where a tree hides it, the horizon beside the tree.
void find_horizon(SkyRatio& s) {
  std::vector<int> lowest(static_cast<std::size_t>(s.width), 0);
  for (int x = 0; x < s.width; ++x)
    for (int y = s.height - 1; y >= 0; --y)
      if (s.sky[static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width) +
                static_cast<std::size_t>(x)]) {
        lowest[static_cast<std::size_t>(x)] = y + 1;
        break;
      }
  const Line line = horizon_line(lowest, s.height);
  const double near = 0.015 * s.height;
  const auto off = [&](int x) { return lowest[static_cast<std::size_t>(x)] - line.row(x); };
  // Sky between boughs does not hang together with the sky above.
  for (int x = 0; x < s.width; ++x) {
    if (off(x) >= -near) continue;
    const int end = std::clamp(static_cast<int>(line.row(x) + near), 0, s.height);
    for (int y = end - 1; y >= lowest[static_cast<std::size_t>(x)] && y >= line.row(x) - near; --y) {
      const float q = s.ratio[static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width) +
                              static_cast<std::size_t>(x)];
      if (q < kSkyFrom || q > kSkyTo) continue;
      lowest[static_cast<std::size_t>(x)] = y + 1;
      break;
    }
  }
  s.horizon = lowest;
  int on_line = 0, before = -1;
  for (int x = 0; x < s.width; ++x) {
    if (off(x) >= -near) {
      on_line += off(x) < near;
      before = x;
      continue;
    }
    int after = x;
    while (after < s.width && off(after) < -near) ++after;
    // Hidden by wood: the horizon goes on from one side to the other, and no higher than either.
    const double left = before >= 0 ? off(before) : after < s.width ? off(after) : 0;
    const double right = after < s.width ? off(after) : left;
    s.horizon[static_cast<std::size_t>(x)] =
        std::clamp(static_cast<int>(std::lround(line.row(x) + std::min({left, right, near}))), 0, s.height);
  }
  s.median_horizon = std::clamp(line.row(s.width / 2), 0.0, static_cast<double>(s.height));
  s.horizon_share = static_cast<double>(on_line) / s.width;
}

void measure_light(SkyRatio& s, const Photograph& photo) {
  s.row_light.assign(static_cast<std::size_t>(s.height), 0);
  std::vector<float> row;
  for (int y = 0; y < s.height; ++y) {
    row.clear();
    for (int x = 0; x < s.width; ++x)
      if (s.sky[photo.pixel(x, y)]) row.push_back(static_cast<float>(luminance(photo, photo.pixel(x, y))));
    float& light = s.row_light[static_cast<std::size_t>(y)];
    if (row.size() > 4) {
      auto middle = row.begin() + static_cast<std::ptrdiff_t>(row.size() / 2);
      std::nth_element(row.begin(), middle, row.end());
      light = std::max(1.0f, *middle);
    } else {
      light = y > 0 ? s.row_light[static_cast<std::size_t>(y - 1)] : 255;
    }
  }
}

void measure_border(SkyRatio& s) {
  int sky = 0, all = 0;
  const auto count = [&](int x, int y) {
    ++all;
    sky +=
        s.sky[static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width) + static_cast<std::size_t>(x)];
  };
  for (int x = 0; x < s.width; ++x) count(x, 0);
  for (const int x : {0, s.width - 1})
    for (int y = 1; y < s.horizon[static_cast<std::size_t>(x)]; ++y) count(x, y);
  s.border_share = all > 0 ? static_cast<double>(sky) / all : 0;
}

}  // namespace

std::optional<SkyRatio> find_sky(const Photograph& photo) {
  Sky sky{photo};
  const int block = std::max(4, photo.height / 20);
  int bottom = std::min(photo.height, 4 * block);
  sky.fit = fit_rows(sky, bottom, true);
  if (share_like(sky, 0, bottom) < 0.4) return std::nullopt;
  while (bottom < photo.height) {
    const int next = std::min(photo.height, bottom + block);
    if (share_like(sky, bottom, next) < 0.25) break;
    bottom = next;
    sky.fit = fit_rows(sky, bottom, false);
  }
  // The last block may hold the horizon; the fit ends above it, the ratio is told a little below.
  const int reach = std::min(photo.height, bottom + 2 * block);
  const Unevenness uneven(sky, bottom);
  SkyRatio result;
  result.width = photo.width;
  result.height = photo.height;
  const auto pixels = static_cast<std::size_t>(photo.width) * static_cast<std::size_t>(photo.height);
  result.ratio.resize(pixels);
  result.sky.assign(pixels, 0);
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x)
      result.ratio[photo.pixel(x, y)] =
          static_cast<float>(sky.blue(x, y) / (sky.value(x, std::min(y, reach)) * uneven.at(x, y)));
  flood_from_top(result, reach);
  find_horizon(result);
  measure_light(result, photo);
  measure_border(result);
  return result;
}

std::optional<double> clear_horizon(const SkyRatio& sky) {
  if (sky.horizon_share > 0.5 && sky.median_horizon < 0.98 * sky.height) return sky.median_horizon;
  return std::nullopt;
}

double luminance(const Photograph& photo, std::size_t pixel) {
  return 0.299 * photo.rgb[3 * pixel] + 0.587 * photo.rgb[3 * pixel + 1] + 0.114 * photo.rgb[3 * pixel + 2];
}

double separability(const SkyRatio& s) {
  std::array<double, 128> histogram{};
  double n = 0;
  for (int x = 0; x < s.width; ++x)
    for (int y = 0; y < s.horizon[static_cast<std::size_t>(x)]; ++y) {
      const float q = s.ratio[static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width) +
                              static_cast<std::size_t>(x)];
      ++histogram[static_cast<std::size_t>(std::clamp(q, 0.0f, 1.26f) * 100)];
      ++n;
    }
  double mean = 0, square = 0;
  for (std::size_t k = 0; k < histogram.size(); ++k) {
    mean += static_cast<double>(k) * histogram[k];
    square += static_cast<double>(k * k) * histogram[k];
  }
  if (n == 0) return 0;
  mean /= n;
  const double variance = square / n - mean * mean;
  double best = 0, below = 0, sum = 0;
  for (std::size_t k = 0; k + 1 < histogram.size(); ++k) {
    below += histogram[k] / n;
    sum += static_cast<double>(k) * histogram[k] / n;
    if (below <= 0 || below >= 1) continue;
    best = std::max(best, std::pow(mean * below - sum, 2) / (below * (1 - below)));
  }
  return variance > 0 ? best / variance : 0;
}

}  // namespace dendrofit
