// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/growth_output.h"

#include "io/json_text.h"

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
  json["interval"] = "wald";
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

}  // namespace

std::string growth_report_json(const GrowthReport& report) {
  ordered_json json;
  if (report.abscissa != "age") json["abscissa"] = report.abscissa;
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
  return json_text(json) + "\n";
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

}  // namespace dendrofit::cli
