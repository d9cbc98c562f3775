// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit growth, as a user runs it: tables in any dress, what it writes, and what grow makes of it.
#include "core/atomic_file.h"
#include "forward/growth_equations.h"
#include "tests/cli/run_program.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using nlohmann::json;
using test::Outcome;
using test::run_program;
using test::ScratchFolder;
using testing::HasSubstr;
using testing::Not;

/// Heights in metres over years, with a ripple that no curve follows.
double height(double age) {
  const std::vector<double> p{0.4, 24, 0.09};  // X0, Xm, r
  return growth_equation("logistic").value(p, age) + 0.15 * std::sin(1.7 * age);
}

std::string table(const std::string& head, char delimiter, char decimal, const std::string& end) {
  std::string text = head + "series" + delimiter + "time" + delimiter + "value" + end;
  for (double age = 5; age <= 80; age += 5) {
    std::string value = std::to_string(height(age));
    if (decimal == ',') value[value.find('.')] = ',';
    text += std::string("fir") + delimiter + std::to_string(static_cast<int>(age)) + delimiter + value + end;
  }
  return text;
}

json fits_of(const std::string& arguments) {
  const Outcome outcome = run_program("growth --json " + arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return json::parse(outcome.out).at("series").at(0).at("fits");
}

TEST(GrowthCommand, the_dress_of_a_table_does_not_matter) {
  const ScratchFolder scratch;
  write_file(scratch / "plain.csv", table("", ',', '.', "\n"));
  const json plain = fits_of((scratch / "plain.csv").string());
  std::string shuffled = "value,time,series,remark\n,7,fir,not measured\nNA,9,fir,\n";
  for (double age = 80; age >= 5; age -= 5)
    shuffled += std::to_string(height(age)) + "," + std::to_string(age) + ",fir,\n";
  const std::map<std::string, std::string> dresses = {
      {"semicolons and decimal commas", table("\xef\xbb\xbf", ';', ',', "\r\n")},
      {"tabs", table("# a remark\n", '\t', '.', "\n")},
      {"other columns, missing values, falling ages", shuffled}};
  for (const auto& [name, text] : dresses) {
    write_file(scratch / "t.csv", text);
    const json fits = fits_of((scratch / "t.csv").string());
    for (const char* equation : {"logistic", "bertalanffy", "weibull"})
      for (const auto& [parameter, value] : plain.at(equation).at("params").items())
        EXPECT_NEAR(fits.at(equation).at("params").at(parameter).at("value").get<double>(),
                    value.at("value").get<double>(), 1e-9 * std::abs(value.at("value").get<double>()))
            << name << " " << equation << " " << parameter;
  }
}

TEST(GrowthCommand, a_table_that_cannot_be_read_names_line_and_column) {
  const ScratchFolder scratch;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"time,value\n1,2\n2,tall\n", "line 3"},
      {"age,height\n1,2\n", "'time' is missing; found: age, height"},
      {"time,value\n", "without rows"},
      {"time,value\n1,2\n3\n", "line 3"},
      {"", "empty"}};
  for (const auto& [text, said] : cases) {
    write_file(scratch / "t.csv", text);
    const Outcome outcome = run_program("growth " + (scratch / "t.csv").string());
    EXPECT_EQ(outcome.code, 3) << text;
    EXPECT_THAT(outcome.err, HasSubstr(said));
  }
}

TEST(GrowthCommand, without_an_answer_the_reason_and_the_json_are_there_and_the_code_is_4) {
  const ScratchFolder scratch;
  for (const std::string text : {"time,value\n10,3\n", "time,value\n1,0\n2,0\n3,0\n4,0\n5,0\n",
                                 "time,value\n1,-2\n2,-3\n3,-4\n4,-4\n5,-5\n",
                                 "time,value\n1990,3\n2000,5\n2010,9\n2015,9.5\n2020,10\n"}) {
    write_file(scratch / "t.csv", text);
    const Outcome outcome = run_program("growth --json " + (scratch / "t.csv").string());
    EXPECT_EQ(outcome.code, 4) << text << outcome.err;
    const json report = json::parse(outcome.out);
    EXPECT_EQ(report.at("error").at("code"), 4);
    EXPECT_THAT(report.at("error").at("message").get<std::string>(), HasSubstr("series '1'"));
    EXPECT_NE(report.at("series").at(0).at("fits").at("logistic").at("status"), "ok");
  }
}

TEST(GrowthCommand, warnings_reach_the_terminal) {
  const ScratchFolder scratch;
  std::string young = "series,time,value\n";
  for (int age = 2; age <= 14; ++age)
    young +=
        "plot 3," + std::to_string(age) + "," + std::to_string(0.02 * age * age + 0.01 * (age % 3)) + "\n";
  write_file(scratch / "t.csv", young);
  const Outcome outcome =
      run_program("growth " + (scratch / "t.csv").string() + " --equations bertalanffy,logistic");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("series 'plot 3'"));
  EXPECT_THAT(outcome.out, HasSubstr("errors are too small: resample whole trees"));
}

TEST(GrowthCommand, pictures_and_tables_are_written) {
  const ScratchFolder scratch;
  write_file(scratch / "t.csv", table("", ',', '.', "\n"));
  ASSERT_EQ(run_program("growth " + (scratch / "t.csv").string() + " -o " + (scratch / "o").string()).code,
            0);
  const auto files = test::files_in(scratch / "o");
  for (const char* name : {"growth.json", "growth.csv", "growth.svg", "growth.png", "run.toml"})
    EXPECT_TRUE(files.count(name)) << name;
  const std::string& svg = files.at("growth.svg");
  std::size_t dots = 0;
  for (auto at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++dots;
  EXPECT_EQ(dots, 16u);  // one a measurement
  const std::string& png = files.at("growth.png");
  EXPECT_TRUE(png.starts_with("\x89PNG"));
  EXPECT_EQ(static_cast<unsigned char>(png[18]) * 256 + static_cast<unsigned char>(png[19]), 1280);
}

TEST(GrowthCommand, parameters_for_grow_count_internodes_and_years_whatever_the_units) {
  const ScratchFolder scratch;
  std::string metres = "time,value\n", feet = metres;
  const std::vector<double> p{0.4, 9, 0.35};
  for (int year = 1; year <= 24; ++year) {
    const double x = growth_equation("logistic").value(p, year);
    metres += std::to_string(year) + "," + std::to_string(x) + "\n";
    feet += std::to_string(12 * year) + "," + std::to_string(x / 0.3048) + "\n";
  }
  write_file(scratch / "m.csv", metres);
  write_file(scratch / "ft.csv", feet);
  const auto params = [&](const std::string& arguments) {
    const Outcome outcome = run_program("growth --force --equations logistic " + arguments +
                                        " --params-out " + (scratch / "p.toml").string());
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return test::content_of(scratch / "p.toml");
  };
  const auto number = [](const std::string& toml, const std::string& key) {
    return std::stod(toml.substr(toml.find("\n" + key + " = ") + key.size() + 4));
  };
  const std::string in_metres = params((scratch / "m.csv").string() + " --internode 5cm");
  EXPECT_NEAR(number(in_metres, "xm"), 180, 0.01);
  EXPECT_NEAR(number(in_metres, "x0"), 8, 0.01);
  EXPECT_NEAR(number(in_metres, "r"), 0.35, 1e-4);
  EXPECT_EQ(number(in_metres, "rho_m"), 0.05);
  EXPECT_EQ(number(in_metres, "cycles"), 24);
  const std::string in_feet =
      params((scratch / "ft.csv").string() + " --internode 5cm --value-unit ft --time-unit months");
  for (const char* key : {"xm", "x0", "r"})
    EXPECT_NEAR(number(in_feet, key) / number(in_metres, key), 1, 1e-4) << key;
  EXPECT_EQ(number(in_feet, "cycles"), 24);

  // What grows from it comes near the measured height: the model's stem loses some to light and whole
  // internodes.
  EXPECT_THAT(params((scratch / "m.csv").string()), HasSubstr("The curve comes to 89."));
  ASSERT_EQ(run_program("grow " + (scratch / "p.toml").string() + " -o " + (scratch / "tree").string()).code,
            0);
  const json metrics = json::parse(test::content_of(scratch / "tree" / "metrics.json"));
  const double curve = growth_equation("logistic").value(p, 24);
  EXPECT_GT(metrics.at("height_m").get<double>(), 0.6 * curve);
  EXPECT_LT(metrics.at("height_m").get<double>(), 1.05 * curve);

  EXPECT_THAT(run_program("growth " + (scratch / "m.csv").string() +
                          " --value-unit m3 --force --params-out " + (scratch / "p.toml").string())
                  .err,
              HasSubstr("counts internodes along the stem"));
}

TEST(GrowthCommand, dated_models_make_a_series_several_at_once) {
  const ScratchFolder scratch;
  std::string from;
  for (int age = 4; age <= 24; age += 4) {
    const std::string name = (scratch / (std::to_string(age) + ".json")).string();
    write_file(name, "{\"height_m\": " + std::to_string(height(age)) + "}");
    from += " " + name + ":" + std::to_string(age);
  }
  const Outcome outcome = run_program("growth --json --from" + from + " -o " + (scratch / "o").string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out).at("series").at(0).at("n"), 6);
  const Outcome again = run_program("growth --json --config " + (scratch / "o" / "run.toml").string());
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out, outcome.out);
}

TEST(GrowthCommand, allometry_gives_height_over_diameter) {
  const ScratchFolder scratch;
  std::string trees = "dbh;height\n";
  for (int d = 6; d <= 60; d += 3) {
    std::string h = std::to_string(1.3 + 27 * (1 - std::exp(-0.035 * std::pow(d, 1.1))) + 0.2 * (d % 5 - 2));
    h[h.find('.')] = ',';
    trees += std::to_string(d) + ";" + h + "\n";
  }
  write_file(scratch / "t.csv", trees);
  const Outcome outcome = run_program("growth --json --allometry " + (scratch / "t.csv").string() + " -o " +
                                      (scratch / "o").string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report.at("abscissa"), "diameter");
  const json& fits = report.at("series").at(0).at("fits");
  EXPECT_EQ(fits.at("power").at("status"), "ok");
  EXPECT_NEAR(fits.at("weibull").at("params").at("w1").at("value").get<double>(), 27, 1.5);
  EXPECT_LT(fits.at("weibull").at("aicc").get<double>(), fits.at("power").at("aicc").get<double>());
  EXPECT_THAT(test::content_of(scratch / "o" / "growth.svg"), HasSubstr("diameter (cm)"));
  EXPECT_THAT(test::content_of(scratch / "o" / "growth.csv"), HasSubstr("1,power,6"));
  write_file(scratch / "t.csv", "dbh,height\n10,8\n20,14\n");
  const Outcome few = run_program("growth --allometry " + (scratch / "t.csv").string());
  EXPECT_EQ(few.code, 4);
  EXPECT_THAT(few.err, HasSubstr("at least 3 trees"));
}

}  // namespace
}  // namespace dendrofit
