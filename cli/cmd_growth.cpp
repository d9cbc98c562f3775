// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit growth TABLE.csv -o DIR
#include "cli/commands.h"
#include "cli/growth_output.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "fit/growth_report.h"
#include "fit/growth_units.h"
#include "forward/growth_equations.h"
#include "io/metrics_json.h"
#include "io/read_table.h"
#include "io/read_tree.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, at);)
    if (!word.empty()) words.push_back(word);
  return words;
}

double plain_number(const std::string& option, const std::string& text) {
  try {
    return parse_quantity(text, Quantity::pure);
  } catch (const std::invalid_argument& error) {
    throw UsageError(option + ": " + error.what());
  }
}

/// "name=value" words as a map.
std::map<std::string, std::string> assignments(const std::string& option,
                                               const std::vector<std::string>& words) {
  std::map<std::string, std::string> map;
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UsageError(option + " " + word + ": expected NAME=VALUE, e.g. " + option + " X0=0.3");
    map[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return map;
}

std::string file_name_of(std::string series) {
  for (char& c : series)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  return series;
}

class Growth : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("TABLE", table_, "Measurements: columns series,time,value (series is optional)",
                       false);
    options.path("--output", output_, "Folder for growth.json, growth.csv and growth.svg", "-o");
    options.texts("--from", from_, "FILE:AGE",
                  "A QSM or metrics.json and the tree's age then, in place of a table; may be repeated");
    options.choice("--quantity", quantity_, {"height", "dbh", "volume"}, "What --from takes of each file");
    options.text("--equations", equations_, "LIST", "Growth equations, comma separated, or 'all'");
    options.text("--time-unit", time_unit_, "UNIT", "Unit of the times: years, months, days");
    options.text("--value-unit", value_unit_, "UNIT",
                 "Unit of the values: m, cm, mm, ft, in, m3, ... or any word");
    options.text("--to-time-unit", to_time_unit_, "UNIT", "Convert the times first");
    options.text("--to-value-unit", to_value_unit_, "UNIT", "Convert the values first");
    options.texts("--fix", fix_, "NAME=VALUE",
                  "Hold a parameter, e.g. X0=0.3 or weibull.w3=2; may be repeated");
    options.texts("--bound", bound_, "NAME=LO:HI",
                  "Bound a parameter ('asymptote' for each equation's own); may be repeated");
    options.texts("--start", start_, "NAME=VALUE",
                  "Starting value tried before the automatic ones; may be repeated");
    options.flag("--fit-offset", fit_offset_, "Fit an offset: X = offset + f(t)");
    options.flag("--fit-time-shift", fit_shift_, "Fit a time shift: X = f(t + shift)");
    options.number("--offset", offset_, Quantity::pure,
                   "Known size at the origin, e.g. 1.3 for breast-height ages");
    options.number("--origin", origin_, Quantity::pure,
                   "Year of germination, where times are calendar years");
    options.choice("--weights", weights_, {"equal", "inverse_value", "inverse_square"},
                   "Weights of the measurements");
    options.choice("--loss", loss_, {"none", "huber", "soft_l1", "cauchy", "arctan", "tukey"}, "Robust loss");
    options.number("--loss-scale", loss_scale_, Quantity::pure,
                   "Residual at which the loss starts to give way, in the values' unit");
    options.number("--confidence", confidence_, Quantity::pure, "Of intervals and bands");
    options.number("--base-age", base_age_, Quantity::pure, "Base age of the site index");
    options.choice("--mixed", mixed_, {"none", "asymptote", "asymptote_and_rate"},
                   "Mixed-effects model over the series");
    options.choice(
        "--mixed-form", mixed_form_, {"shape", "start"},
        "What the series share in the mixed model: the curve's shape in time, or the size at age 0");
    options.text("--ages", ages_, "LIST",
                 "Ages of the curves and bands, comma separated (default: 60 over the data)");
    options.flag("--no-profile", no_profile_,
                 "Wald limits in place of profile-likelihood ones (faster, less honest)");
    options.flag("--no-pooled", no_pooled_, "No fit of all series as one");
    options.flag("--trunk-base-unmeasured", base_unmeasured_,
                 "The first years are missing from the measurements");
    options.path("--params-out", params_out_, "Also write the best fit as parameters for dendrofit grow");
    options.text("--params-equation", params_equation_, "NAME",
                 "Of that file (default: the best among the growth model's)");
  }

  int run(Session& session) override {
    const GrowthOptions options = resolve(session.common());
    std::vector<fs::path> inputs;
    const std::vector<MeasurementSeries> series = read(options, inputs);
    if (!params_out_.empty()) prepare_output_file(params_out_, session.common());
    const fs::path folder = output_.empty() ? fs::path() : prepare_output_folder(output_, session.common());

    const GrowthReport report = fit_growth(series, options, session.progress());
    if (!folder.empty()) write(folder, report, run_record(session, inputs));
    session.json(growth_report_json(report));
    say(session, report);
    if (!report.any_ok()) {
      if (session.common().json) return 4;
      throw SolverError(report.series.front().fits.front().reason);
    }
    if (!params_out_.empty()) write_file(params_out_, params_of(report));
    if (!folder.empty())
      session.say("Written to " + folder.string() + ": growth.json, growth.csv, growth.svg");
    return 0;
  }

 private:
  GrowthOptions resolve(const CommonOptions& common) const {
    GrowthOptions options;
    options.equations.clear();
    if (equations_ == "all")
      for (const GrowthEquation& equation : growth_equations()) options.equations.emplace_back(equation.name);
    else
      options.equations = split(equations_, ',');
    for (const auto& [name, value] : assignments("--fix", fix_))
      options.fixed[name] = plain_number("--fix", value);
    for (const auto& [name, range] : assignments("--bound", bound_)) {
      const auto colon = range.find(':');
      if (colon == std::string::npos)
        throw UsageError("--bound " + name + "=" + range + ": expected NAME=LO:HI (either may be empty)");
      GrowthBounds& bounds = options.bounds[name];
      if (colon > 0) bounds.lo = plain_number("--bound", range.substr(0, colon));
      if (colon + 1 < range.size()) bounds.hi = plain_number("--bound", range.substr(colon + 1));
    }
    options.fit_offset = fit_offset_;
    options.fit_time_shift = fit_shift_;
    options.offset = offset_;
    options.origin_time = origin_;
    options.weights = growth_weights(weights_);
    options.loss = growth_loss(loss_);
    options.loss_scale = loss_scale_;
    options.confidence = confidence_;
    options.base_age = base_age_;
    options.mixed = mixed_ == "none"        ? GrowthMixedEffects::none
                    : mixed_ == "asymptote" ? GrowthMixedEffects::asymptote
                                            : GrowthMixedEffects::asymptote_and_rate;
    options.mixed_form = mixed_form_ == "shape" ? GrowthMixedForm::shape : GrowthMixedForm::start;
    for (const auto& [name, value] : assignments("--start", start_))
      options.start[name] = plain_number("--start", value);
    for (const std::string& age : split(ages_, ','))
      options.band_times.push_back(plain_number("--ages", age));
    options.profile_intervals = !no_profile_;
    options.pooled = !no_pooled_;
    options.trunk_base_unmeasured = base_unmeasured_;
    options.time_unit = to_time_unit_.empty() ? time_unit_ : to_time_unit_;
    options.value_unit = to_value_unit_.empty() ? value_unit_ : to_value_unit_;
    options.threads = common.threads;
    options.validate();
    return options;
  }

  std::vector<MeasurementSeries> read(const GrowthOptions& options, std::vector<fs::path>& inputs) const {
    if (table_.empty() == from_.empty())
      throw UsageError("growth: give either a table or --from FILE:AGE ...");
    std::vector<MeasurementSeries> series =
        from_.empty() ? read_measurements(table_) : std::vector{dated_models(inputs)};
    if (from_.empty()) inputs.push_back(table_);
    const auto factor = [](const std::string& has, const std::string& wanted) {
      return has == wanted ? 1.0 : unit_factor(has, wanted);
    };
    return convert_units(std::move(series), factor(time_unit_, options.time_unit),
                         factor(value_unit_, options.value_unit));
  }

  MeasurementSeries dated_models(std::vector<fs::path>& inputs) const {
    MeasurementSeries series;
    series.name = quantity_;
    for (const std::string& word : from_) {
      const auto colon = word.rfind(':');
      if (colon == std::string::npos)
        throw UsageError("--from " + word + ": expected FILE:AGE, e.g. 2019/metrics.json:12");
      const fs::path file = word.substr(0, colon);
      const TreeMetrics metrics =
          file.extension() == ".json" ? metrics_from_json(file) : measure(read_tree(file));
      if (quantity_ == "dbh" && !metrics.dbh_m)
        throw InputError(file.string() + ": the tree has no DBH (it is too low)");
      series.time.push_back(plain_number("--from", word.substr(colon + 1)));
      series.value.push_back(quantity_ == "height" ? metrics.height_m
                             : quantity_ == "dbh"  ? *metrics.dbh_m
                                                   : metrics.total_volume_m3);
      inputs.push_back(file);
    }
    return series;
  }

  static void write(const fs::path& folder, const GrowthReport& report, const std::string& record) {
    constexpr std::size_t kMostPictures = 60;
    write_file(folder / "growth.json", growth_report_json(report));
    write_file(folder / "growth.csv", growth_curves_csv(report));
    write_file(folder / "growth.svg",
               growth_svg(report, report.series.size() == 1 ? &report.series.front() : nullptr));
    write_file(folder / "run.toml", record);
    if (report.series.size() == 1 || report.series.size() > kMostPictures) return;
    fs::create_directories(folder / "series");
    for (const GrowthSeries& series : report.series)
      if (!series.best.empty())
        write_file(folder / "series" / (file_name_of(series.name) + ".svg"), growth_svg(report, &series));
  }

  static void say(const Session& session, const GrowthReport& report) {
    constexpr std::size_t kMostTables = 5;
    for (std::size_t i = 0; i < std::min(kMostTables, report.series.size()); ++i) {
      session.say(growth_table(report, report.series[i]));
      if (report.series.size() == 1) session.say(growth_plot_text(report.series[i]));
    }
    if (report.series.size() > kMostTables)
      session.say(
          fmt::format("... and {} more series (growth.json has all)", report.series.size() - kMostTables));
    if (report.pooled) {
      session.say(growth_table(report, *report.pooled));
      session.say(growth_plot_text(*report.pooled));
    }
    for (const std::string& warning : report.warnings) session.warn(warning);
  }

  std::string params_of(const GrowthReport& report) const {
    const GrowthSeries& series = report.pooled ? *report.pooled : report.series.front();
    if (!params_equation_.empty()) return growth_params_toml(series, params_equation_);
    const GrowthFit* best = nullptr;
    for (const GrowthFit& fit : series.fits)
      if (fit.status == GrowthStatus::ok &&
          (fit.equation == "logistic" || fit.equation == "bertalanffy" || fit.equation == "weibull"))
        if (!best || fit.aicc < best->aicc) best = &fit;
    if (!best)
      throw SolverError(
          "--params-out: none of the growth model's equations (logistic, bertalanffy, weibull) fits these "
          "measurements");
    return growth_params_toml(series, best->equation);
  }

  fs::path table_, output_, params_out_;
  std::vector<std::string> from_, fix_, bound_, start_;
  std::string quantity_ = "height", equations_ = "logistic,bertalanffy,weibull";
  std::string time_unit_ = "years", value_unit_ = "m", to_time_unit_, to_value_unit_;
  std::string weights_ = "equal", loss_ = "none", mixed_ = "none", mixed_form_ = "shape", params_equation_,
              ages_;
  bool no_profile_ = false, no_pooled_ = false, fit_offset_ = false, fit_shift_ = false,
       base_unmeasured_ = false;
  double offset_ = 0, loss_scale_ = 1, confidence_ = 0.95;
  std::optional<double> origin_, base_age_;
};

}  // namespace

std::unique_ptr<Command> make_growth() {
  return std::make_unique<Growth>();
}

}  // namespace dendrofit::cli
