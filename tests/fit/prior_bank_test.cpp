// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/prior_bank.h"

#include "core/errors.h"
#include "fit/descriptors.h"
#include "fit/search_space.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

PriorBank small_bank() {
  PriorBank bank;
  bank.stamp = {1, 2.5f, std::numeric_limits<float>::quiet_NaN()};
  bank.descriptors.resize(3, 2);
  bank.descriptors << 0, 5, 1, std::numeric_limits<float>::quiet_NaN(), 3, 5;
  bank.noise.push_back({(Eigen::MatrixXd(2, 2) << 4, 0.5, 0.5, 1).finished()});
  return bank;
}

TEST(PriorBank, survives_being_written_and_read) {
  const PriorBank bank = small_bank();
  const std::string bytes = encode_bank(bank);
  EXPECT_EQ(bytes, encode_bank(bank));
  const PriorBank again = decode_bank(bytes, "test");
  EXPECT_EQ(again.size(), 3u);
  EXPECT_EQ(again.stamp[1], 2.5f);
  ASSERT_EQ(again.noise.size(), 1u);
  EXPECT_EQ(again.noise[0].covariance, bank.noise[0].covariance);
  EXPECT_NEAR(again.descriptors(1, 0), 1, 3.0 / 65534);
  EXPECT_EQ(again.descriptors(2, 1), 5);
  EXPECT_TRUE(std::isnan(again.descriptors(1, 1)));
}

TEST(PriorBank, damaged_bytes_are_refused) {
  const std::string bytes = encode_bank(small_bank());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(decode_bank(std::string_view(bytes).substr(0, length), "cut.bank"), IoError) << length;
  std::string other = bytes;
  other[3] ^= 1;
  EXPECT_THROW(decode_bank(other, "other.bank"), IoError);
  std::string flipped = bytes;
  flipped[bytes.size() / 2 + 10] ^= 0x55;
  EXPECT_THROW(decode_bank(flipped, "flipped.bank"), IoError);
}

TEST(PriorBank, draws_do_not_depend_on_each_other_and_fill_the_box) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(SearchSpace("logistic").size());
  constexpr int kDraws = 800;
  for (int i = 0; i < kDraws; ++i) sum += prior_draw(static_cast<std::uint64_t>(i)).unit;
  for (const double s : sum) EXPECT_NEAR(s / kDraws, 0.5, 0.05);
  EXPECT_EQ(prior_draw(7).unit, prior_draw(7).unit);
  double shares = 0;
  for (const std::string& equation : SearchSpace::equations()) shares += prior_share(equation);
  EXPECT_DOUBLE_EQ(shares, 1);
}

TEST(PriorBank, another_model_or_other_descriptors_make_it_stale) {
  PriorBank bank;
  bank.stamp = model_stamp();
  EXPECT_TRUE(why_stale(bank));  // without the noise between seeds
  bank.noise.resize(kVisibleShares.size());
  EXPECT_FALSE(why_stale(bank));
  bank.stamp.back() += 0.1f;
  EXPECT_NE(why_stale(bank)->find("grows other trees"), std::string::npos);
  bank.stamp = model_stamp();
  bank.stamp[0] += 1;
  EXPECT_NE(why_stale(bank)->find("descriptors"), std::string::npos);
  bank.stamp.pop_back();
  EXPECT_TRUE(why_stale(bank));
}

TEST(PriorBank, the_one_in_the_repository_fits_the_model) {
  const std::filesystem::path file =
      std::filesystem::path(DENDROFIT_SOURCE_DIR) / "fit" / "data" / "igm.bank";
  std::ifstream in(file, std::ios::binary);
  ASSERT_TRUE(in) << file;
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const PriorBank bank = decode_bank(bytes, file.string());
  const auto stale = why_stale(bank);
  EXPECT_FALSE(stale) << *stale << ": run scripts/make_bank";
  EXPECT_GE(bank.size(), 500u);
  EXPECT_EQ(static_cast<std::size_t>(bank.descriptors.cols()),
            descriptor_table().size() * kVisibleShares.size());
  const std::vector<double> again = simulate_draw(3);
  for (Eigen::Index j = 0; j < bank.descriptors.cols(); ++j) {
    const double kept = bank.descriptors(3, j), now = again[static_cast<std::size_t>(j)];
    EXPECT_TRUE((std::isnan(kept) && std::isnan(now)) || std::abs(kept - now) < 0.01 * (1 + std::abs(now)))
        << j;
  }
}

}  // namespace
}  // namespace dendrofit
