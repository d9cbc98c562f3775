// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit growth TABLE.csv -o DIR
#include "cli/commands.h"
#include "cli/growth_output.h"
#include "cli/growth_params.h"
#include "cli/growth_plot.h"
#include "cli/growth_settings.h"
#include "cli/growth_table.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "fit/growth_allometry.h"
#include "fit/growth_report.h"
#include "fit/growth_units.h"
#include "io/json_text.h"
#include "io/metrics_json.h"
#include "io/read_table.h"
#include "io/read_tree.h"

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

/// A file name for each series: letters and digits of its name, numbered where two would be the same.
std::string file_name_of(std::string series, std::set<std::string>& taken) {
  for (char& c : series)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  series = series.substr(0, 100);
  std::string name = series;
  for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", series, k);
  return name;
}

class Growth : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("TABLE", table_, "Measurements: columns series,time,value (series is optional)",
                       false);
    options.path("--output", output_, "Folder for growth.json, growth.csv, growth.svg and growth.png", "-o");
    options.texts(
        "--from", from_, "FILE:AGE",
        "A QSM or metrics.json and the tree's age then, in place of a table; several at once or repeated",
        true);
    options.choice("--quantity", quantity_, {"height", "dbh", "volume"}, "What --from takes of each file");
    settings_.declare(options);
    options.path("--params-out", params_out_,
                 "Also write a fitted height curve as parameters for dendrofit grow (internodes and cycles)");
    options.text("--params-equation", params_equation_, "NAME",
                 "Equation of that file (default: the best of logistic, bertalanffy and weibull)");
    options.text("--params-series", params_series_, "NAME",
                 "Series of that file (default: the only one, or the pooled curve)");
    options.number("--internode", internode_m_, Quantity::length,
                   "Length of an internode, for that file (default: the growth model's)");
  }

  int run(Session& session) override {
    if (!params_out_.empty() && settings_.allometry)
      throw UsageError("--params-out: heights over diameters tell no growth over time");
    if (!from_.empty() && quantity_ == "volume" && settings_.value_unit == "m") settings_.value_unit = "m3";
    const GrowthOptions options = settings_.resolve(session.common());
    std::vector<fs::path> inputs;
    const std::vector<MeasurementSeries> series = read(options, inputs);
    if (!params_out_.empty()) prepare_output_file(params_out_, session.common());
    const fs::path folder = output_.empty() ? fs::path() : prepare_output_folder(output_, session.common());

    const GrowthReport report = settings_.allometry
                                    ? fit_allometry(series, settings_.forms(), options, session.progress())
                                    : fit_growth(series, options, session.progress());
    if (!folder.empty()) write(folder, report, run_record(session, inputs));
    say(session, report);
    if (!report.any_ok()) {
      const std::string why = report.series.front().fits.front().reason +
                              (report.series.size() > 1 ? " (and no other series has an answer)" : "");
      auto json = nlohmann::ordered_json::parse(growth_report_json(report));
      json.update(nlohmann::ordered_json::parse(error_json(4, why)));
      session.json(json_text(json));
      throw SolverError(why);
    }
    if (!params_out_.empty()) write_file(params_out_, params_of(report, options));
    session.json(growth_report_json(report));
    if (!folder.empty())
      session.say("Written to " + folder.string() + ": growth.json, growth.csv, growth.svg, growth.png");
    if (!params_out_.empty())
      session.say("Written to " + params_out_.string() +
                  ": dendrofit grow takes it (its first lines say what the curve comes to)");
    return 0;
  }

 private:
  std::vector<MeasurementSeries> read(const GrowthOptions& options, std::vector<fs::path>& inputs) const {
    if (table_.empty() == from_.empty())
      throw UsageError("growth: give either a table or --from FILE:AGE ...");
    ReadTableOptions columns;
    if (settings_.allometry) {
      if (!from_.empty()) throw UsageError("--allometry: give a table with the columns dbh,height");
      columns.time_column = "dbh";
      columns.value_column = "height";
    }
    std::vector<MeasurementSeries> series =
        from_.empty() ? read_measurements(table_, columns) : std::vector{dated_models(inputs)};
    if (from_.empty()) inputs.push_back(table_);
    const auto factor = [](const std::string& has, const std::string& wanted) {
      return has == wanted ? 1.0 : unit_factor(has, wanted);
    };
    return convert_units(std::move(series),
                         settings_.allometry ? 1.0 : factor(settings_.time_unit, options.time_unit),
                         factor(settings_.value_unit, options.value_unit));
  }

  MeasurementSeries dated_models(std::vector<fs::path>& inputs) const {
    MeasurementSeries series;
    series.name = quantity_;
    for (const std::string& word : from_) {
      const auto colon = word.rfind(':');
      if (colon == std::string::npos || colon == 0)
        throw UsageError("--from " + word + ": expected FILE:AGE, e.g. 2019/metrics.json:12");
      const fs::path file = word.substr(0, colon);
      const double age = option_number("--from " + word, word.substr(colon + 1));
      const TreeMetrics metrics =
          file.extension() == ".json" ? metrics_from_json(file) : measure(read_tree(file));
      if (quantity_ == "dbh" && !metrics.dbh_m)
        throw InputError(file.string() +
                         ": the tree has no DBH (it is too low); use --quantity height, or leave "
                         "this file out");
      series.time.push_back(age);
      series.value.push_back(quantity_ == "height" ? metrics.height_m
                             : quantity_ == "dbh"  ? *metrics.dbh_m
                                                   : metrics.total_volume_m3);
      inputs.push_back(file);
    }
    return series;
  }

  static void write_pictures(const fs::path& folder, const std::string& name, const CurvePicture& picture) {
    write_file(folder / (name + ".svg"), curve_svg(picture));
    write_png(folder / (name + ".png"), curve_image(picture));
  }

  static void write(const fs::path& folder, const GrowthReport& report, const std::string& record) {
    constexpr std::size_t kMostPictures = 60;
    write_file(folder / "growth.json", growth_report_json(report));
    write_file(folder / "growth.csv", growth_curves_csv(report));
    write_pictures(folder, "growth", growth_picture(report));
    write_file(folder / "run.toml", record);
    if (report.series.size() == 1 || report.series.size() > kMostPictures) return;
    fs::create_directories(folder / "series");
    std::set<std::string> taken;
    for (const GrowthSeries& series : report.series)
      if (!series.best.empty())
        write_pictures(folder / "series", file_name_of(series.name, taken), growth_picture(report, &series));
  }

  static void say(const Session& session, const GrowthReport& report) {
    constexpr std::size_t kMostTables = 5;
    for (std::size_t i = 0; i < std::min(kMostTables, report.series.size()); ++i) {
      session.say(growth_table(report, report.series[i]));
      if (report.series.size() == 1) session.say(curve_text(growth_picture(report, &report.series[i])));
    }
    if (report.series.size() > kMostTables)
      session.say(
          fmt::format("... and {} more series (growth.json has all)\n", report.series.size() - kMostTables));
    if (report.pooled) {
      session.say(growth_table(report, *report.pooled));
      session.say(curve_text(growth_picture(report)));
    }
    for (const GrowthMixed& mixed : report.mixed) session.say(mixed_table(report, mixed));
    // What a table on the terminal has told already is not said twice.
    std::set<std::string> told;
    if (!session.common().json && !session.common().quiet)
      for (std::size_t i = 0; i < std::min(kMostTables, report.series.size()); ++i)
        for (const GrowthFit& fit : report.series[i].fits) told.insert(fit.reason);
    for (const std::string& warning : report.warnings)
      if (!told.contains(warning)) session.warn(warning);
  }

  const GrowthSeries& params_series(const GrowthReport& report) const {
    if (params_series_.empty()) {
      if (report.pooled) return *report.pooled;
      if (report.series.size() == 1) return report.series.front();
      throw UsageError("--params-out: several series and no pooled curve; name one with --params-series");
    }
    for (const GrowthSeries& series : report.series)
      if (series.name == params_series_) return series;
    throw InputError("--params-series " + params_series_ + ": no series of that name in the table");
  }

  std::string params_of(const GrowthReport& report, const GrowthOptions& options) const {
    if (quantity_ != "height" && !from_.empty())
      throw InputError(
          "--params-out: the growth model counts internodes along the stem: use --quantity height");
    const GrowthSeries& series = params_series(report);
    const GrowthFit* chosen = nullptr;
    for (const GrowthFit& fit : series.fits) {
      const bool wanted =
          params_equation_.empty()
              ? fit.status == GrowthStatus::ok &&
                    (fit.equation == "logistic" || fit.equation == "bertalanffy" || fit.equation == "weibull")
              : fit.equation == params_equation_;
      if (wanted && (!chosen || fit.aicc < chosen->aicc)) chosen = &fit;
    }
    if (!chosen)
      throw SolverError(
          params_equation_.empty()
              ? "--params-out: none of logistic, bertalanffy and weibull fits these measurements"
              : "--params-equation " + params_equation_ + ": not among the fitted --equations");
    return growth_params_toml(report, series, *chosen, options.offset, internode_m_);
  }

  fs::path table_, output_, params_out_;
  std::vector<std::string> from_;
  std::string quantity_ = "height", params_equation_, params_series_;
  std::optional<double> internode_m_;
  GrowthSettings settings_;
};

}  // namespace

std::unique_ptr<Command> make_growth() {
  return std::make_unique<Growth>();
}

}  // namespace dendrofit::cli
