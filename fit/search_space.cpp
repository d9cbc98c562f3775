// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/search_space.h"

#include "core/errors.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

constexpr double kStartSize = 2;  // internodes at age 0 (Table 2)

// Ranges about Table 2's trees and what the authors' program runs; see the model's parameter table for
// meanings. Size and maturity: trees of about 40 to 110 internodes, half to fully grown.
const std::vector<SearchRow> kRows = {
    {"size", 50, 150, SearchScale::logarithmic, false},
    {"maturity", 0.45, 0.99, SearchScale::linear, false},
    {"cycles", 6, 26, SearchScale::whole, false},
    {"shape", 1.5, 3, SearchScale::linear, true},
    {"k", 0.15, 0.85},
    {"lambda", 0.46, 0.58},
    {"mu", 0.3, 2.0},
    {"gamma", -1.5, 1.5},
    {"shed_ratio", 0.05, 0.55},
    {"branch_angle_deg", 15, 80},
    {"pipe_exponent", 1.8, 3.5},
    {"tip_share", 0.005, 0.06, SearchScale::logarithmic},  // tip radius over internode length
    {"tau", 0, 14},
    {"alpha", 6, 16, SearchScale::logarithmic},
    {"sigma", 0.2, 0.8},
    {"b_min", 1.6, 2.0},
    {"b_rise", 0.1, 0.8},  // b_max - b_min
};

}  // namespace

const std::vector<std::string>& SearchSpace::equations() {
  static const std::vector<std::string> names = {"logistic", "bertalanffy", "weibull"};
  return names;
}

SearchSpace::SearchSpace(const std::string& equation)
    : base_(igm_preset("table2-06").parameters), rows_(kRows), fixed_(kRows.size()) {
  if (std::find(equations().begin(), equations().end(), equation) == equations().end())
    throw InputError("fit: equation '" + equation + "': expected logistic, bertalanffy or weibull");
  base_.set_equation(equation);
}

Eigen::Index SearchSpace::row(std::string_view key) const {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].key == key) return static_cast<Eigen::Index>(i);
  throw InputError("fit: '" + std::string(key) + "' is not searched");
}

void SearchSpace::fix(std::string_view key, double value) {
  fixed_[static_cast<std::size_t>(row(key))] = value;
}

void SearchSpace::fix_course(const GrowthCourse& course) {
  const auto& cycles = fixed_[static_cast<std::size_t>(row("cycles"))];
  if (!cycles) throw InputError("fit: a known time course needs the tree's age");
  course_ = course;
  fix("maturity", growth_equation(base_.equation).value(course.equation_values, *cycles));
  fix("shape", base_.equation == "weibull" ? course.equation_values[2] : 2.0);
}

void SearchSpace::limit(std::string_view key, double lo, double hi) {
  SearchRow& r = rows_[static_cast<std::size_t>(row(key))];
  r.lo = lo;
  r.hi = hi;
}

double SearchSpace::value(Eigen::Index row, double unit) const {
  const auto i = static_cast<std::size_t>(row);
  if (fixed_[i]) return *fixed_[i];
  const SearchRow& r = rows_[i];
  unit = std::clamp(unit, 0.0, 1.0);
  if (r.scale == SearchScale::logarithmic) return r.lo * std::pow(r.hi / r.lo, unit);
  if (r.scale == SearchScale::whole) return std::min(r.hi, std::floor(r.lo + unit * (r.hi - r.lo + 1)));
  return r.lo + unit * (r.hi - r.lo);
}

double SearchSpace::unit(Eigen::Index row, double value) const {
  const SearchRow& r = rows_[static_cast<std::size_t>(row)];
  double unit = (value - r.lo) / (r.hi - r.lo);
  if (r.scale == SearchScale::logarithmic) unit = std::log(value / r.lo) / std::log(r.hi / r.lo);
  if (r.scale == SearchScale::whole) unit = (value - r.lo + 0.5) / (r.hi - r.lo + 1);
  return std::clamp(unit, 0.0, 1.0);
}

void SearchSpace::set_course(IgmParameters& parameters, double size, double maturity, double cycles,
                             double shape) const {
  const double most = size / maturity;
  if (course_) {
    const GrowthEquation& equation = growth_equation(base_.equation);
    parameters.equation_values = course_->equation_values;
    parameters.equation_values[equation.asymptote_row] = most;
    if (base_.equation == "logistic") parameters.equation_values[0] = course_->equation_values[0] * most;
  } else if (base_.equation == "logistic") {  // X(T) = size: eq. 1 solved for r
    const double r = (std::log(most / kStartSize - 1) + std::log(maturity / (1 - maturity))) / cycles;
    parameters.equation_values = {kStartSize, most, r};
  } else if (base_.equation == "bertalanffy") {
    parameters.equation_values = {most, -std::log(1 - std::cbrt(maturity)) / cycles};
  } else {
    parameters.equation_values = {most, -std::log(1 - maturity) / std::pow(cycles, shape), shape};
  }
}

IgmParameters SearchSpace::at(const Eigen::VectorXd& unit) const {
  const auto of = [&](std::string_view key) {
    const Eigen::Index i = row(key);
    return value(i, unit[i]);
  };
  IgmParameters parameters = base_;
  set_course(parameters, of("size"), of("maturity"), of("cycles"), of("shape"));
  for (const std::string_view key : {"k", "lambda", "mu", "gamma", "shed_ratio", "branch_angle_deg",
                                     "pipe_exponent", "tau", "alpha", "sigma", "b_min", "cycles"})
    parameters.set(key, of(key));
  parameters.gamma_late = parameters.gamma;
  parameters.b_max = parameters.b_min + of("b_rise");
  parameters.tip_radius_m = of("tip_share") * parameters.rho_m;
  return parameters;
}

std::vector<ReportedRow> SearchSpace::reported() const {
  std::vector<ReportedRow> rows;
  for (const ParameterSpec& spec : growth_equation(base_.equation).parameters) {
    if (course_ || spec.key == "x0") continue;
    ReportedRow r{std::string(spec.key), std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity()};
    for (int corner = 0; corner < 16; ++corner) {
      Eigen::VectorXd unit = Eigen::VectorXd::Constant(size(), 0.5);
      int bit = 1;
      for (const char* key : {"size", "maturity", "cycles", "shape"}) {
        unit[row(key)] = corner & bit ? 1 : 0;
        bit *= 2;
      }
      const double v = at(unit).get(r.key);
      r.lo = std::min(r.lo, v);
      r.hi = std::max(r.hi, v);
    }
    rows.push_back(r);
  }
  for (const char* key : {"cycles", "k", "lambda", "mu", "gamma", "shed_ratio", "branch_angle_deg",
                          "pipe_exponent", "tau", "alpha", "sigma", "b_min"}) {
    const Eigen::Index i = row(key);
    if (!fixed(i)) rows.push_back({key, value(i, 0), value(i, 1)});
  }
  const Eigen::Index base = row("b_min"), rise = row("b_rise");
  rows.push_back({"b_max", value(base, 0) + value(rise, 0), value(base, 1) + value(rise, 1)});
  return rows;
}

Eigen::VectorXd SearchSpace::report(const Eigen::VectorXd& unit, const std::vector<ReportedRow>& rows) const {
  const IgmParameters parameters = at(unit);
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = parameters.get(rows[i].key);
  return values;
}

}  // namespace dendrofit
