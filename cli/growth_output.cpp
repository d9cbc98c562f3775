// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/growth_output.h"

#include "core/errors.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

using nlohmann::ordered_json;

ordered_json number(double x) {
  if (std::isnan(x)) return nullptr;
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return x;
}

std::string exact(double x) {
  if (std::isnan(x)) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", x);
  return text;
}

std::string brief(double x) {
  if (std::isnan(x)) return "-";
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

ordered_json parameter_json(const GrowthParameter& parameter) {
  ordered_json json{{"value", number(parameter.value)},
                    {"se", number(parameter.se)},
                    {"ci_lo", number(parameter.lo)},
                    {"ci_hi", number(parameter.hi)}};
  if (!parameter.unit.empty()) json["unit"] = parameter.unit;
  if (parameter.fixed) json["fixed"] = true;
  if (parameter.at_bound) json["at_bound"] = true;
  return json;
}

ordered_json derived_json(const GrowthDerived& derived) {
  ordered_json json{{"asymptote", number(derived.asymptote)},
                    {"inflection_age", number(derived.inflection_age)},
                    {"inflection_value", number(derived.inflection_value)},
                    {"max_increment", number(derived.max_increment)},
                    {"mai_culmination_age", number(derived.mai_culmination_age)},
                    {"max_mai", number(derived.max_mai)},
                    {"years_to_breast_height", number(derived.years_to_breast_height)},
                    {"asymptote_se", number(derived.asymptote_se)},
                    {"inflection_age_se", number(derived.inflection_age_se)},
                    {"max_increment_se", number(derived.max_increment_se)},
                    {"mai_culmination_age_se", number(derived.mai_culmination_age_se)}};
  if (!std::isnan(derived.scale_age)) json["scale_age"] = derived.scale_age;
  if (!std::isnan(derived.site_index)) {
    json["site_index"] = number(derived.site_index);
    json["site_index_se"] = number(derived.site_index_se);
  }
  return json;
}

ordered_json fit_json(const GrowthFit& fit) {
  ordered_json json{{"status", growth_status_name(fit.status)}, {"reason", fit.reason}};
  ordered_json params = ordered_json::object();
  if (fit.status == GrowthStatus::ok || fit.status == GrowthStatus::ill_conditioned)
    for (const GrowthParameter& parameter : fit.parameters)
      params[parameter.name] = parameter_json(parameter);
  json["params"] = params;
  json["n"] = fit.n;
  json["rss"] = number(fit.rss);
  json["sigma"] = number(fit.sigma);
  json["aic"] = number(fit.aic);
  json["aicc"] = number(fit.aicc);
  json["bic"] = number(fit.bic);
  json["rss_limit"] = number(fit.rss_limit);
  if (fit.status != GrowthStatus::ok) return json;
  json["asymptote_bounded"] = fit.asymptote_bounded;
  json["interval"] = fit.profiled ? "profile" : "wald";
  if (!std::isnan(fit.robust_cost)) json["robust_cost"] = fit.robust_cost;
  json["residual_lag1"] = number(fit.residual_lag1);
  json["derived"] = derived_json(fit.derived);
  if (fit.second_best)
    json["second_best"] = {{"params", fit.second_best->parameters}, {"rss", fit.second_best->rss}};
  json["warnings"] = fit.warnings;
  return json;
}

ordered_json series_json(const GrowthSeries& series) {
  ordered_json fits = ordered_json::object();
  for (const GrowthFit& fit : series.fits) fits[fit.equation] = fit_json(fit);
  ordered_json best = nullptr;
  if (!series.best.empty()) best = series.best;
  return {{"name", series.name},
          {"n", series.time.size()},
          {"best", best},
          {"warnings", series.warnings},
          {"fits", fits}};
}

ordered_json mixed_json(const GrowthMixed& mixed) {
  ordered_json json{{"status", growth_status_name(mixed.status)}, {"reason", mixed.reason}};
  if (mixed.status != GrowthStatus::ok) return json;
  ordered_json fixed = ordered_json::object(), random = ordered_json::object(),
               series = ordered_json::object();
  for (const GrowthParameter& parameter : mixed.fixed) fixed[parameter.name] = parameter_json(parameter);
  for (std::size_t i = 0; i < mixed.random.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    random[mixed.random[i]] = {{"sd", std::sqrt(mixed.random_covariance(k, k))}};
  }
  for (const GrowthMixedSeries& one : mixed.series) {
    ordered_json own = ordered_json::object();
    for (std::size_t i = 0; i < one.parameters.size(); ++i) own[mixed.fixed[i].name] = one.parameters[i];
    series[one.name] = own;
  }
  json["n"] = mixed.n;
  json["fixed"] = fixed;
  json["random"] = random;
  if (mixed.random.size() == 2)
    json["random_correlation"] = mixed.random_covariance(0, 1) /
                                 std::sqrt(mixed.random_covariance(0, 0) * mixed.random_covariance(1, 1));
  json["sigma"] = mixed.sigma;
  json["log_likelihood"] = mixed.log_likelihood;
  json["aic"] = mixed.aic;
  json["bic"] = mixed.bic;
  json["series"] = series;
  return json;
}

const GrowthFit* best_fit(const GrowthSeries& series) {
  return series.best.empty() ? nullptr : series.fit(series.best);
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

void append_bands(std::ostringstream& csv, const std::string& series, const std::string& equation,
                  const std::vector<GrowthBandPoint>& bands) {
  for (const GrowthBandPoint& point : bands) {
    csv << quoted(series) << ',' << equation;
    for (double x : {point.time, point.fit, point.se, point.confidence_lo, point.confidence_hi,
                     point.prediction_lo, point.prediction_hi, point.cai, point.mai})
      csv << ',' << exact(x);
    csv << '\n';
  }
}

std::string escaped(const std::string& text) {
  std::string result;
  for (char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else
      result += c;
  }
  return result;
}

// Round steps 1, 2, 5 x 10^k, about `count` of them up to `range`.
double tick_step(double range, int count) {
  const double raw = range / count, power = std::pow(10, std::floor(std::log10(raw)));
  for (double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10 * power;
}

// Data coordinates to the drawing's.
struct Frame {
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  static constexpr double kLeft = 70, kRight = 620, kTop = 40, kBottom = 390;
  double x(double t) const { return kLeft + (t - x0) / (x1 - x0) * (kRight - kLeft); }
  double y(double v) const { return kBottom - (v - y0) / (y1 - y0) * (kBottom - kTop); }
};

std::string area(const Frame& frame, const std::vector<GrowthBandPoint>& bands, double GrowthBandPoint::*lo,
                 double GrowthBandPoint::*hi, const char* colour) {
  std::ostringstream path;
  path.precision(6);
  const auto at = [&](double t, double v) {
    path << frame.x(t) << ',' << frame.y(std::clamp(v, frame.y0, frame.y1)) << ' ';
  };
  path << "<polygon fill=\"" << colour << "\" stroke=\"none\" points=\"";
  for (const auto& point : bands) at(point.time, point.*hi);
  for (auto point = bands.rbegin(); point != bands.rend(); ++point) at(point->time, (*point).*lo);
  path << "\"/>\n";
  return path.str();
}

}  // namespace

std::string growth_report_json(const GrowthReport& report) {
  ordered_json json;
  json["time_unit"] = report.time_unit;
  json["value_unit"] = report.value_unit;
  json["confidence"] = report.confidence;
  json["series"] = ordered_json::array();
  for (const GrowthSeries& series : report.series) json["series"].push_back(series_json(series));
  json["pooled"] = nullptr;
  if (report.pooled) json["pooled"] = series_json(*report.pooled);
  json["mixed"] = nullptr;
  for (const GrowthMixed& mixed : report.mixed) json["mixed"][mixed.equation] = mixed_json(mixed);
  json["warnings"] = report.warnings;
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string growth_curves_csv(const GrowthReport& report) {
  std::ostringstream csv;
  csv << "series,equation,time,fit,se,confidence_lo,confidence_hi,prediction_lo,prediction_hi,cai,mai\n";
  for (const GrowthSeries& series : report.series)
    for (const GrowthFit& fit : series.fits) append_bands(csv, series.name, fit.equation, fit.bands);
  if (report.pooled)
    for (const GrowthFit& fit : report.pooled->fits) append_bands(csv, "pooled", fit.equation, fit.bands);
  for (const GrowthMixed& mixed : report.mixed)
    append_bands(csv, "population", mixed.equation, mixed.population);
  return csv.str();
}

std::string growth_svg(const GrowthReport& report, const GrowthSeries* series) {
  if (!series)
    series = report.pooled ? &*report.pooled : report.series.empty() ? nullptr : &report.series.front();
  std::ostringstream svg;
  svg.precision(6);
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 450\" font-family=\"sans-serif\" "
         "font-size=\"13\">\n<rect width=\"640\" height=\"450\" fill=\"white\"/>\n";
  if (!series || series->time.empty())
    return svg.str() + "<text x=\"40\" y=\"60\">no measurements</text>\n</svg>\n";
  const GrowthFit* fit = best_fit(*series);
  Frame frame;
  frame.x0 = std::min(0.0, *std::min_element(series->time.begin(), series->time.end()));
  frame.x1 = *std::max_element(series->time.begin(), series->time.end());
  frame.y0 = std::min(0.0, *std::min_element(series->value.begin(), series->value.end()));
  frame.y1 = *std::max_element(series->value.begin(), series->value.end());
  if (fit)
    for (const auto& point : fit->bands) {
      frame.x1 = std::max(frame.x1, point.time);
      if (std::isfinite(point.prediction_hi))
        frame.y1 = std::max(frame.y1, std::min(point.prediction_hi, 1.5 * frame.y1));
    }
  const double dx = tick_step(std::max(frame.x1 - frame.x0, 1e-9), 8),
               dy = tick_step(std::max(frame.y1 - frame.y0, 1e-9), 7);
  frame.x1 = dx * std::ceil(frame.x1 / dx - 1e-9);
  frame.y1 = dy * std::ceil(frame.y1 / dy - 1e-9);
  if (!(frame.x1 > frame.x0)) frame.x1 = frame.x0 + dx;
  if (!(frame.y1 > frame.y0)) frame.y1 = frame.y0 + dy;
  for (double t = dx * std::ceil(frame.x0 / dx); t <= frame.x1 + 1e-9 * dx; t += dx)
    svg << "<line x1=\"" << frame.x(t) << "\" x2=\"" << frame.x(t)
        << "\" y1=\"40\" y2=\"390\" stroke=\"#e4e4e4\"/><text x=\"" << frame.x(t)
        << "\" y=\"408\" text-anchor=\"middle\">" << brief(std::abs(t) < 1e-9 * dx ? 0 : t) << "</text>\n";
  for (double v = dy * std::ceil(frame.y0 / dy); v <= frame.y1 + 1e-9 * dy; v += dy)
    svg << "<line x1=\"70\" x2=\"620\" y1=\"" << frame.y(v) << "\" y2=\"" << frame.y(v)
        << "\" stroke=\"#e4e4e4\"/><text x=\"62\" y=\"" << frame.y(v) + 4 << "\" text-anchor=\"end\">"
        << brief(std::abs(v) < 1e-9 * dy ? 0 : v) << "</text>\n";
  if (fit && !fit->bands.empty()) {
    svg << area(frame, fit->bands, &GrowthBandPoint::prediction_lo, &GrowthBandPoint::prediction_hi,
                "#e6f0e2");
    svg << area(frame, fit->bands, &GrowthBandPoint::confidence_lo, &GrowthBandPoint::confidence_hi,
                "#b9d8ae");
    svg << "<polyline fill=\"none\" stroke=\"#2e6b1f\" stroke-width=\"2\" points=\"";
    for (const auto& point : fit->bands)
      svg << frame.x(point.time) << ',' << frame.y(std::clamp(point.fit, frame.y0, frame.y1)) << ' ';
    svg << "\"/>\n";
  }
  for (std::size_t i = 0; i < series->time.size(); ++i)
    svg << "<circle r=\"3\" fill=\"#333\" cx=\"" << frame.x(series->time[i]) << "\" cy=\""
        << frame.y(series->value[i]) << "\"/>\n";
  svg << "<rect x=\"70\" y=\"40\" width=\"550\" height=\"350\" fill=\"none\" stroke=\"#333\"/>\n";
  std::string title = series->name;
  if (fit)
    title += ": " + std::string(growth_equation(fit->equation).title) + ", " +
             brief(100 * report.confidence) + " % bands";
  svg << "<text x=\"70\" y=\"28\" font-size=\"15\">" << escaped(title)
      << "</text>\n<text x=\"345\" y=\"434\" text-anchor=\"middle\">age (" << escaped(report.time_unit)
      << ")</text>\n<text transform=\"translate(18,215) rotate(-90)\" text-anchor=\"middle\">size ("
      << escaped(report.value_unit) << ")</text>\n</svg>\n";
  return svg.str();
}

std::string growth_table(const GrowthReport& report, const GrowthSeries& series) {
  std::ostringstream text;
  text << series.name << ": " << series.time.size() << " measurements";
  if (!series.best.empty()) text << ", best by AICc: " << growth_equation(series.best).title;
  text << "\n";
  for (const GrowthFit& fit : series.fits) {
    char head[120];
    if (fit.status != GrowthStatus::ok) {
      std::snprintf(head, sizeof head,
                    "  %-17s %s: ", std::string(growth_equation(fit.equation).title).c_str(),
                    growth_status_name(fit.status).c_str());
      text << head << fit.reason << "\n";
      continue;
    }
    std::snprintf(head, sizeof head, "  %-17s AICc %-9s error %-8s asymptote %-9s %s\n",
                  std::string(growth_equation(fit.equation).title).c_str(), brief(fit.aicc).c_str(),
                  brief(fit.sigma).c_str(), brief(fit.derived.asymptote).c_str(),
                  fit.asymptote_bounded ? "bounded by the data" : "NOT bounded by the data");
    text << head;
    for (const GrowthParameter& parameter : fit.parameters) {
      text << "      " << parameter.name << " = " << brief(parameter.value) << " " << parameter.unit;
      if (parameter.fixed)
        text << " (fixed)";
      else
        text << " [" << brief(parameter.lo) << ", " << brief(parameter.hi) << "]";
      text << "\n";
    }
    text << "      inflection at " << brief(fit.derived.inflection_age) << " " << report.time_unit
         << ", largest increment " << brief(fit.derived.max_increment) << ", mean increment culminates at "
         << brief(fit.derived.mai_culmination_age) << "\n";
  }
  return text.str();
}

std::string growth_plot_text(const GrowthSeries& series, int columns, int rows) {
  const GrowthFit* fit = best_fit(series);
  if (series.time.empty() || columns < 10 || rows < 4) return {};
  double t0 = std::min(0.0, *std::min_element(series.time.begin(), series.time.end()));
  double t1 = *std::max_element(series.time.begin(), series.time.end());
  double v0 = std::min(0.0, *std::min_element(series.value.begin(), series.value.end()));
  double v1 = *std::max_element(series.value.begin(), series.value.end());
  if (!(t1 > t0)) t1 = t0 + 1;
  if (!(v1 > v0)) v1 = v0 + 1;
  std::vector<std::string> canvas(static_cast<std::size_t>(rows),
                                  std::string(static_cast<std::size_t>(columns), ' '));
  const auto mark = [&](double t, double v, char c) {
    const double x = (t - t0) / (t1 - t0) * (columns - 1), y = (v - v0) / (v1 - v0) * (rows - 1);
    if (!(x >= 0 && x < columns && y >= 0 && y < rows)) return;
    canvas[static_cast<std::size_t>(rows - 1 - std::lround(y))][static_cast<std::size_t>(std::lround(x))] = c;
  };
  if (fit)
    for (std::size_t i = 0; i + 1 < fit->bands.size(); ++i)
      for (int k = 0; k < 4; ++k) {
        const GrowthBandPoint &a = fit->bands[i], &b = fit->bands[i + 1];
        mark(a.time + k * (b.time - a.time) / 4, a.fit + k * (b.fit - a.fit) / 4, '.');
      }
  for (std::size_t i = 0; i < series.time.size(); ++i) mark(series.time[i], series.value[i], 'o');
  std::ostringstream text;
  for (int row = 0; row < rows; ++row) {
    char label[16];
    std::snprintf(label, sizeof label, "%9s |",
                  row == 0          ? brief(v1).c_str()
                  : row == rows - 1 ? brief(v0).c_str()
                                    : "");
    text << label << canvas[static_cast<std::size_t>(row)] << "\n";
  }
  text << "          +" << std::string(static_cast<std::size_t>(columns), '-') << "\n           " << brief(t0)
       << std::string(static_cast<std::size_t>(std::max(1, columns - 8)), ' ') << brief(t1) << "\n";
  return text.str();
}

std::string growth_params_toml(const GrowthSeries& series, const std::string& equation) {
  const GrowthFit* fit = series.fit(equation);
  if (!fit || fit->status != GrowthStatus::ok)
    throw InputError("no parameters to write for series '" + series.name + "', " +
                     std::string(growth_equation(equation).title) +
                     (fit ? ": " + fit->reason : ": not fitted"));
  std::ostringstream toml;
  std::string name = series.name;  // a comment must stay one line
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  toml << "# growth curve of series '" << name << "', fitted to " << fit->n << " measurements\nequation = \""
       << equation << "\"\n";
  const auto& table = growth_equation(equation).parameters;
  for (std::size_t i = 0; i < table.size(); ++i) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", fit->parameters[i].value);
    std::string value = text;
    if (value.find_first_of(".e") == std::string::npos) value += ".0";
    toml << table[i].key << " = " << value << "\n";
  }
  return toml.str();
}

}  // namespace dendrofit::cli
