// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/leaf_laws.h"

#include "cli/parse.h"
#include "core/errors.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t to = text.find(at); to != std::string::npos; to = text.find(at, from)) {
    parts.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  parts.push_back(text.substr(from));
  return parts;
}

/// A law's word and the numbers after its colon.
struct Spelled {
  std::string word;
  std::vector<double> numbers;
};

Spelled spelled(const std::string& text, const std::string& option) {
  Spelled law;
  const std::size_t colon = text.find(':');
  law.word = text.substr(0, colon);
  if (colon == std::string::npos) return law;
  for (const std::string& number : split(text.substr(colon + 1), ',')) try {
      law.numbers.push_back(parse_quantity(number, Quantity::pure));
    } catch (const std::invalid_argument& fault) {
      throw UsageError(fmt::format("{} {}: {}", option, text, fault.what()));
    }
  return law;
}

void need(const Spelled& law, std::size_t count, const std::string& example, const std::string& option) {
  if (law.numbers.size() != count)
    throw UsageError(fmt::format("{}: '{}' takes {} numbers, {} found; expected {}", option, law.word, count,
                                 law.numbers.size(), example));
}

UnitDistribution one_distribution(const std::string& text, const std::string& option) {
  const Spelled law = spelled(text, option);
  if (law.word == "uniform") {
    need(law, 0, "uniform", option);
    return UnitDistribution::uniform();
  }
  if (law.word == "table") {
    if (law.numbers.empty()) throw UsageError(option + ": a table needs weights, as in table:1,2,4");
    return UnitDistribution::histogram(law.numbers);
  }
  if (law.word == "beta") {
    need(law, 2, "beta:2,3", option);
    return UnitDistribution::beta(law.numbers[0], law.numbers[1]);
  }
  if (law.word == "weibull") {
    need(law, 2, "weibull:0.6,2", option);
    return UnitDistribution::weibull(law.numbers[0], law.numbers[1]);
  }
  if (law.word == "von-mises") {
    need(law, 2, "von-mises:0.5,2", option);
    return UnitDistribution::von_mises(law.numbers[0], law.numbers[1]);
  }
  throw UsageError(fmt::format(
      "{}: '{}' is no distribution; expected uniform, beta:A,B, weibull:SCALE,SHAPE, von-mises:MEAN,KAPPA or "
      "table:W1,W2,...",
      option, text));
}

}  // namespace

UnitDistribution unit_distribution_from(const std::string& text, const std::string& option) {
  std::vector<UnitDistribution> parts;
  std::vector<double> weights;
  for (const std::string& term : split(text, '+')) {
    const std::size_t star = term.find('*');
    double weight = 1;
    if (star != std::string::npos) {
      const Spelled number = spelled("weight:" + term.substr(0, star), option);
      weight = number.numbers.front();
    }
    weights.push_back(weight);
    parts.push_back(one_distribution(star == std::string::npos ? term : term.substr(star + 1), option));
  }
  UnitDistribution law =
      parts.size() == 1 ? parts.front() : UnitDistribution::mixture(std::move(parts), std::move(weights));
  law.validate(option);
  return law;
}

InclinationLaw inclination_law_from(const std::string& text, const std::string& option) {
  const Spelled law = spelled(text, option);
  InclinationLaw out;
  if (law.word == "beta") {
    need(law, 2, "beta:2,3", option);
    out.kind = InclinationLaw::Kind::beta;
    out.a = law.numbers[0];
    out.b = law.numbers[1];
  } else if (law.word == "ellipsoidal") {
    need(law, 1, "ellipsoidal:1.5", option);
    out.kind = InclinationLaw::Kind::ellipsoidal;
    out.a = law.numbers[0];
  } else if (law.word == "table") {
    if (law.numbers.empty()) throw UsageError(option + ": a table needs weights, as in table:5,9,4");
    out.kind = InclinationLaw::Kind::table;
    out.table = law.numbers;
  } else {
    need(law, 0, "planophile", option);
    try {
      out = inclination_law(law.word);
    } catch (const InputError& fault) {
      throw UsageError(fmt::format("{}: {}", option, fault.what()));
    }
  }
  out.validate(option);
  return out;
}

void set_profile(const std::string& text, LeafProfile& profile) {
  const std::size_t equals = text.find('=');
  const std::string place = text.substr(0, equals);
  const std::pair<std::string_view, std::optional<UnitDistribution>*> places[] = {
      {"height", &profile.height},   {"along-axis", &profile.along_axis},
      {"compass", &profile.compass}, {"radius", &profile.radius},
      {"order", &profile.order},     {"tip-distance", &profile.tip_distance}};
  const auto found = std::find_if(std::begin(places), std::end(places),
                                  [&](const auto& entry) { return entry.first == place; });
  if (equals == std::string::npos || found == std::end(places))
    throw UsageError(
        fmt::format("--profile {}: expected PLACE=LAW with height, along-axis, compass, radius, order or "
                    "tip-distance, as in "
                    "height=beta:2,3",
                    text));
  if (*found->second) throw UsageError(fmt::format("--profile {}: {} is given twice", text, place));
  *found->second = unit_distribution_from(text.substr(equals + 1), "--profile " + place);
}

}  // namespace dendrofit::cli
