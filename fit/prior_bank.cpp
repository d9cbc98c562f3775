// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/prior_bank.h"

#include "core/parallel.h"
#include "core/random.h"
#include "fit/descriptors.h"
#include "fit/search_space.h"
#include "forward/igm/grow.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

namespace dendrofit {
namespace {

constexpr std::uint64_t kBankSeed = 0xba7e5;
constexpr std::array<const char*, 4> kEquations = {"logistic", "bertalanffy", "logistic", "weibull"};
constexpr double kStampTolerance = 2e-3;
constexpr std::size_t kNoiseGroups = 150, kReplicates = 4;
constexpr float kUsualLeast = 40, kUsualMost = 110;  // internodes

/// Trees of the stamp: small, of each equation, with shedding and shade at work.
struct StampTree {
  const char* equation;
  double size, cycles, unit;
};
constexpr std::array<StampTree, 3> kStampTrees = {
    {{"logistic", 45, 9, 0.5}, {"bertalanffy", 42, 8, 0.4}, {"weibull", 44, 10, 0.6}}};

std::vector<double> describe_grown(const SearchSpace& space, const Eigen::VectorXd& unit,
                                   std::uint64_t seed) {
  const IgmParameters parameters = space.at(unit);
  IgmOptions options;
  options.seed = seed;
  const Tree tree = grow_igm(parameters, {}, options).tree;
  return describe_at_all_levels(tree, {.internode_length_m = parameters.rho_m});
}

std::uint64_t digest(std::uint64_t hash, std::string_view text) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

/// Names and ranges of everything a bank's columns and draws mean.
std::uint64_t table_digest() {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const DescriptorRow& row : descriptor_table()) hash = digest(hash, fmt::format("{};", row.name));
  for (const double share : kVisibleShares) hash = digest(hash, fmt::format("{};", share));
  const SearchSpace space("logistic");
  for (const SearchRow& row : space.rows())
    hash = digest(hash, fmt::format("{} {} {} {};", row.key, row.lo, row.hi, static_cast<int>(row.scale)));
  return hash;
}

bool differ(float a, float b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return std::abs(a - b) > kStampTolerance * (1 + std::abs(a));
}

}  // namespace

PriorDraw prior_draw(std::uint64_t index) {
  PriorDraw draw;
  draw.equation = kEquations[index % kEquations.size()];
  draw.unit.resize(SearchSpace(draw.equation).size());
  Random random = Random(kBankSeed).child({index});
  for (double& u : draw.unit) u = random.uniform();
  draw.seed = random.bits();
  return draw;
}

double prior_share(const std::string& equation) {
  double share = 0;
  for (const char* name : kEquations) share += name == equation ? 1.0 / kEquations.size() : 0.0;
  return share;
}

std::vector<double> simulate_draw(std::uint64_t index, std::uint64_t replicate) {
  const PriorDraw draw = prior_draw(index);
  const std::uint64_t seed = replicate == 0 ? draw.seed : Random(draw.seed).child({replicate}).bits();
  return describe_grown(SearchSpace(draw.equation), draw.unit, seed);
}

std::vector<SeedNoise> measure_seed_noise(const Eigen::MatrixXf& draws, int threads) {
  const auto internodes = static_cast<Eigen::Index>(descriptor_row("internodes"));
  std::vector<Eigen::Index> usual;
  for (Eigen::Index i = 0; i < draws.rows() && usual.size() < kNoiseGroups; ++i)
    if (const float size = std::exp(draws(i, internodes)); size >= kUsualLeast && size <= kUsualMost)
      usual.push_back(i);
  std::vector<Eigen::MatrixXd> groups(usual.size(), Eigen::MatrixXd(kReplicates, draws.cols()));
  parallel_blocks(usual.size() * kReplicates, 1, threads, [&](std::size_t task, std::size_t) {
    const std::size_t group = task / kReplicates, replicate = task % kReplicates;
    const std::vector<double> values = simulate_draw(static_cast<std::uint64_t>(usual[group]), replicate);
    groups[group].row(static_cast<Eigen::Index>(replicate)) =
        Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  });
  const auto columns = static_cast<Eigen::Index>(descriptor_table().size());
  std::vector<SeedNoise> noise;
  for (std::size_t level = 0; level < kVisibleShares.size(); ++level) {
    std::vector<Eigen::MatrixXd> at_level;
    for (const Eigen::MatrixXd& group : groups)
      at_level.push_back(group.middleCols(static_cast<Eigen::Index>(level) * columns, columns));
    noise.push_back(noise_within(at_level));
  }
  return noise;
}

std::vector<float> model_stamp() {
  std::vector<float> stamp;
  std::uint64_t hash = table_digest();
  for (int part = 0; part < 4; ++part, hash >>= 16) stamp.push_back(static_cast<float>(hash & 0xffff));
  for (const StampTree& tree : kStampTrees) {
    SearchSpace space(tree.equation);
    space.fix("size", tree.size);
    space.fix("cycles", tree.cycles);
    for (const double value : describe_grown(space, Eigen::VectorXd::Constant(space.size(), tree.unit), 7))
      stamp.push_back(static_cast<float>(value));
  }
  return stamp;
}

std::optional<std::string> why_stale(const PriorBank& bank) {
  const std::vector<float> now = model_stamp();
  if (bank.stamp.size() != now.size() || bank.noise.size() != kVisibleShares.size())
    return "it was made for other descriptors";
  for (std::size_t i = 0; i < 4; ++i)
    if (bank.stamp[i] != now[i]) return "it was made for other descriptors or parameter ranges";
  for (std::size_t i = 4; i < now.size(); ++i)
    if (differ(bank.stamp[i], now[i])) return "the growth model grows other trees than when it was made";
  return {};
}

}  // namespace dendrofit
