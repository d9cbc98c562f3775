// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace dendrofit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostGridPoints = 120;  // more measurements than this are thinned for the grid alone

std::vector<double> spaced(double from, double to, int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) values[i] = from + (to - from) * i / std::max(1, count - 1);
  return values;
}

std::vector<double> log_spaced(double from, double to, int count) {
  return spaced(std::log(from), std::log(to), count);
}

// Ages dense inside [first, last] and sparse to three times the range on both sides.
std::vector<double> age_axis(double first, double last, int count) {
  std::vector<double> ages;
  const double middle = 0.5 * (first + last), half = 0.5 * (last - first);
  for (double u : spaced(-1, 1, count))
    ages.push_back(middle + half * std::sinh(2.6 * u) / std::sinh(2.6) * 7);
  return ages;
}

// Chart coordinates 1.. of the grid, by equation.
std::vector<std::vector<double>> shape_axes(const GrowthEquation& equation, const GrowthData& data) {
  const auto [first, last] = std::minmax_element(data.time.begin(), data.time.end());
  const double range = std::max(*last - *first, 1e-12 * std::abs(*last)), end = std::max(*last, range);
  const std::string_view name = equation.name;
  if (name == "logistic" || name == "gompertz")
    return {log_spaced(0.1 / range, 100 / range, 36), age_axis(*first, *last, 50)};
  if (name == "richards")
    return {log_spaced(0.3 / range, 60 / range, 16), age_axis(*first, *last, 30), log_spaced(0.05, 20, 7)};
  if (name == "bertalanffy") return {log_spaced(1e-3 / end, 300 / end, 200)};
  if (name == "chapman_richards") return {log_spaced(1e-3 / end, 100 / end, 50), log_spaced(0.1, 20, 36)};
  if (name == "weibull") return {log_spaced(0.02 * end, 1e3 * end, 50), log_spaced(0.1, 20, 36)};
  if (name == "korf") return {log_spaced(0.01 * end, 1e4 * end, 50), log_spaced(0.05, 10, 36)};
  if (name == "hossfeld4") return {log_spaced(0.02 * end, 1e3 * end, 50), log_spaced(0.1, 20, 36)};
  // monomolecular: rate, and the age of size 0
  return {log_spaced(1e-3 / range, 100 / range, 50), spaced(*first - 3 * range, *last, 36)};
}

GrowthData thinned(const GrowthData& data) {
  if (data.size() <= kMostGridPoints) return data;
  std::vector<int> order(static_cast<std::size_t>(data.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return data.time[a] < data.time[b]; });
  GrowthData few;
  for (int k = 0; k < kMostGridPoints; ++k) {
    const int i =
        order[static_cast<std::size_t>(static_cast<double>(k) * (data.size() - 1) / (kMostGridPoints - 1))];
    few.time.push_back(data.time[i]);
    few.value.push_back(data.value[i]);
    few.weight.push_back(data.weight[i]);
  }
  return few;
}

// Scale and offset of unit curve g that fit best by weighted least squares; cost infinite for a scale not
// above 0.
struct LinearFit {
  double scale = 0, offset = 0, cost = kInfinity;
};

LinearFit linear_fit(const std::vector<double>& g, const GrowthData& data, const std::vector<double>& weight,
                     double base, bool with_offset) {
  double s = 0, sg = 0, sy = 0, sgg = 0, sgy = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const double w = weight[i], y = data.value[i] - base;
    s += w;
    sg += w * g[i];
    sy += w * y;
    sgg += w * g[i] * g[i];
    sgy += w * g[i] * y;
  }
  LinearFit fit;
  if (with_offset) {
    const double determinant = s * sgg - sg * sg;
    if (!(determinant > 1e-14 * s * sgg)) return fit;
    fit.scale = (s * sgy - sg * sy) / determinant;
    fit.offset = (sy - fit.scale * sg) / s;
  } else {
    fit.scale = sgy / sgg;
  }
  if (!(fit.scale > 0) || !std::isfinite(fit.scale)) return fit;
  fit.cost = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const double residual = base + fit.offset + fit.scale * g[i] - data.value[i];
    fit.cost += weight[i] * residual * residual;
  }
  return fit;
}

constexpr int kRobustScales = 60;

// The same under a robust loss, which has several minima: the three lowest over a logarithmic axis of scales,
// reweighted. `steps` tells where on that axis each is.
std::vector<LinearFit> robust_fits(const std::vector<double>& g, const GrowthData& data, double base,
                                   bool with_offset, GrowthLoss loss, double loss_scale,
                                   std::vector<int>& steps) {
  const double largest = *std::max_element(g.begin(), g.end());
  double lowest = kInfinity, highest = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const double ratio = (data.value[i] - base) / g[i];
    if (!(g[i] > 1e-3 * largest) || !(ratio > 0)) continue;
    lowest = std::min(lowest, ratio);
    highest = std::max(highest, ratio);
  }
  steps.clear();
  if (!(highest > 0)) return {};
  std::vector<double> weight(g.size());
  const auto evaluate = [&](LinearFit& fit) {
    fit.cost = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      const double residual = base + fit.offset + fit.scale * g[i] - data.value[i];
      const auto rho = evaluate_loss(loss, loss_scale, data.weight[i] * residual * residual);
      fit.cost += rho[0];
      weight[i] = data.weight[i] * std::max(rho[1], 1e-12);
    }
  };
  std::vector<LinearFit> along(kRobustScales);
  for (int k = 0; k < kRobustScales; ++k) {
    along[k].scale = lowest * std::pow(highest / lowest, k / (kRobustScales - 1.0));
    evaluate(along[k]);
  }
  std::vector<int> minima;
  for (int k = 0; k < kRobustScales; ++k)
    if ((k == 0 || along[k].cost <= along[k - 1].cost) &&
        (k + 1 == kRobustScales || along[k].cost <= along[k + 1].cost))
      minima.push_back(k);
  std::stable_sort(minima.begin(), minima.end(), [&](int a, int b) { return along[a].cost < along[b].cost; });
  if (minima.size() > 3) minima.resize(3);
  std::vector<LinearFit> fits;
  for (int k : minima) {
    LinearFit best = along[k], fit = along[k];
    for (int pass = 0; pass < 4; ++pass) {
      evaluate(fit);
      if (fit.cost < best.cost) best = fit;
      const LinearFit next = linear_fit(g, data, weight, base, with_offset);
      if (!std::isfinite(next.cost)) break;
      fit.scale = next.scale;
      fit.offset = next.offset;
    }
    fits.push_back(best);
    steps.push_back(k);
  }
  return fits;
}

struct Cell {
  std::array<int, 5> at{};  // grid indices, then the time shift's and a robust scale's
  GrowthVector natural;
  double cost = kInfinity;
};

int distance(const Cell& a, const Cell& b) {
  int largest = 0;
  for (std::size_t k = 0; k < a.at.size(); ++k) largest = std::max(largest, std::abs(a.at[k] - b.at[k]));
  return largest;
}

// Golden-section minimum of f in [lo, hi] around a bracketed lowest point.
template <class F>
double golden_minimum(const F& f, double lo, double hi) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1);
  double a = hi - ratio * (hi - lo), b = lo + ratio * (hi - lo), fa = f(a), fb = f(b);
  for (int i = 0; i < 100 && hi - lo > 1e-12 * (std::abs(lo) + std::abs(hi)); ++i) {
    if (fa <= fb) {
      hi = b;
      b = a;
      fb = fa;
      a = hi - ratio * (hi - lo);
      fa = f(a);
    } else {
      lo = a;
      a = b;
      fa = fb;
      b = lo + ratio * (hi - lo);
      fb = f(b);
    }
  }
  return fa <= fb ? a : b;
}

// Lowest of f over an ascending axis, refined between the neighbours of the lowest point.
template <class F>
double refined_minimum(const F& f, const std::vector<double>& axis) {
  std::size_t best = 0;
  double lowest = kInfinity;
  for (std::size_t i = 0; i < axis.size(); ++i)
    if (const double value = f(axis[i]); value < lowest) {
      lowest = value;
      best = i;
    }
  return golden_minimum(f, axis[best > 0 ? best - 1 : 0], axis[std::min(best + 1, axis.size() - 1)]);
}

enum class LimitKind { exponential, power, cubic, linear };

LimitKind limit_kind(std::string_view name) {
  if (name == "bertalanffy") return LimitKind::cubic;
  if (name == "monomolecular") return LimitKind::linear;
  if (name == "logistic" || name == "gompertz" || name == "richards") return LimitKind::exponential;
  return LimitKind::power;
}

// First-order change of the limit curve's size x at age t as the final size becomes finite (up to a positive
// factor).
double finite_size_change(std::string_view name, double x, double t, double growth) {
  if (name == "logistic") return -x * x * -std::expm1(-growth * t);
  if (name == "gompertz" || name == "monomolecular") return -(name == "gompertz" ? x : 1) * t * t;
  if (name == "bertalanffy" || name == "chapman_richards") return -x * t;
  if (name == "weibull" || name == "hossfeld4") return -x * x;
  if (name == "korf") return t > 0 ? -x * std::log(t) * std::log(t) : 0;
  return 0;
}

}  // namespace

std::vector<GrowthVector> automatic_starts(const GrowthCurve& curve, const GrowthData& all, GrowthLoss loss,
                                           double loss_scale, int most) {
  const GrowthData data = thinned(all);
  const GrowthEquation& equation = curve.equation();
  const auto axes = shape_axes(equation, data);
  const double range = *std::max_element(data.time.begin(), data.time.end()) -
                       *std::min_element(data.time.begin(), data.time.end());
  const std::vector<double> shifts =
      curve.has_time_shift() ? std::vector<double>{0, 0.1 * range, 0.3 * range, -0.1 * range, 0.7 * range}
                             : std::vector<double>{0};
  std::vector<Cell> cells;
  std::vector<double> g(data.time.size());
  const GrowthCurve plain(equation, false, false);
  std::array<int, 4> size{1, 1, 1, static_cast<int>(shifts.size())};
  for (std::size_t k = 0; k < axes.size(); ++k) size[k] = static_cast<int>(axes[k].size());
  for (int i = 0; i < size[0]; ++i)
    for (int j = 0; j < size[1]; ++j)
      for (int k = 0; k < size[2]; ++k)
        for (int s = 0; s < size[3]; ++s) {
          GrowthVector c = GrowthVector::Zero(plain.size());
          c[1] = axes[0][i];
          if (axes.size() > 1) c[2] = axes[1][j];
          if (axes.size() > 2) c[3] = axes[2][k];
          const GrowthVector unit = plain.to_natural(GrowthChart::shape, c);
          for (std::size_t q = 0; q < g.size(); ++q) g[q] = plain.value(unit, data.time[q] + shifts[s]);
          std::vector<int> steps{0};
          const std::vector<LinearFit> fits =
              loss == GrowthLoss::none
                  ? std::vector<LinearFit>{linear_fit(g, data, data.weight, curve.base(), curve.has_offset())}
                  : robust_fits(g, data, curve.base(), curve.has_offset(), loss, loss_scale, steps);
          for (std::size_t q = 0; q < fits.size(); ++q) {
            if (!std::isfinite(fits[q].cost)) continue;
            c[0] = std::log(fits[q].scale);
            Cell cell{{i, j, k, 3 * s, steps[q]}, GrowthVector(curve.size()), fits[q].cost};
            cell.natural.head(plain.size()) = plain.to_natural(GrowthChart::shape, c);
            if (curve.has_offset()) cell.natural[curve.own_size()] = fits[q].offset;
            if (curve.has_time_shift()) cell.natural[curve.size() - 1] = shifts[s];
            cells.push_back(std::move(cell));
          }
        }
  std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.cost < b.cost; });
  std::vector<const Cell*> chosen;
  for (const Cell& cell : cells) {
    if (static_cast<int>(chosen.size()) == most) break;
    if (std::all_of(chosen.begin(), chosen.end(),
                    [&](const Cell* other) { return distance(*other, cell) >= 3; }))
      chosen.push_back(&cell);
  }
  std::vector<GrowthVector> starts;
  for (const Cell* cell : chosen) starts.push_back(cell->natural);
  return starts;
}

GrowthLimit fit_limit_curve(const GrowthCurve& curve, const GrowthData& data) {
  const LimitKind kind = limit_kind(curve.equation().name);
  const auto ends = std::minmax_element(data.time.begin(), data.time.end());
  const double first = *ends.first, last = *ends.second;
  const double range = last - first, end = std::max(std::abs(last), range);
  std::vector<double> g(data.time.size());
  double shift = 0;
  // Exponents are scaled to the last age so that nothing overflows; the scale takes it up.
  const auto fit_at = [&](double growth) {
    for (std::size_t i = 0; i < g.size(); ++i) {
      const double t = data.time[i] + shift;
      if (kind == LimitKind::exponential) g[i] = std::exp(growth * (t - last));
      if (kind == LimitKind::power) g[i] = t > 0 ? std::pow(t / end, growth) : 0;
      if (kind == LimitKind::cubic) g[i] = t > 0 ? std::pow(t / end, 3) : 0;
      if (kind == LimitKind::linear) g[i] = t / end;
    }
    return linear_fit(g, data, data.weight, curve.base(), curve.has_offset() || kind == LimitKind::linear);
  };
  const auto best_growth = [&] {
    if (kind == LimitKind::cubic || kind == LimitKind::linear) return 0.0;
    const auto cost = [&](double log_growth) { return fit_at(std::exp(log_growth)).cost; };
    return std::exp(kind == LimitKind::exponential
                        ? refined_minimum(cost, log_spaced(1e-4 / range, 300 / range, 80))
                        : refined_minimum(cost, log_spaced(1e-3, 60, 80)));
  };
  if (curve.has_time_shift())
    shift = refined_minimum(
        [&](double s) {
          shift = s;
          return fit_at(best_growth()).cost;
        },
        spaced(-0.9 * std::max(first, 0.0), 3 * range, 25));
  const double growth = best_growth();
  const LinearFit fit = fit_at(growth);
  GrowthLimit limit{fit.cost, 0};
  if (!std::isfinite(fit.cost) || curve.has_time_shift()) return limit;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const double size = fit.scale * g[i];
    const double residual = curve.base() + fit.offset + size - data.value[i];
    limit.slope +=
        2 * data.weight[i] * residual * finite_size_change(curve.equation().name, size, data.time[i], growth);
  }
  return limit;
}

}  // namespace dendrofit
