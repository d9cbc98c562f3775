// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/simulation_log.h"

#include "core/errors.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(SimulationLog, gives_back_what_was_added) {
  SimulationLog log(42);
  log.add(7, {1, 2.5});
  log.add(9, {});
  SimulationLog again(42);
  again.restore(log.bytes(12.5));
  EXPECT_EQ(again.size(), 2u);
  EXPECT_EQ(again.earlier_seconds(), 12.5);
  ASSERT_TRUE(again.find(7));
  EXPECT_EQ(*again.find(7), (std::vector<double>{1, 2.5}));
  EXPECT_FALSE(again.find(8));
}

TEST(SimulationLog, refuses_another_fits_log_and_damage) {
  SimulationLog log(42);
  log.add(7, {1, 2.5});
  const std::string bytes = log.bytes(0);
  EXPECT_THROW(SimulationLog(43).restore(bytes), InputError);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(SimulationLog(42).restore(std::string_view(bytes).substr(0, length)), IoError) << length;
  EXPECT_THROW(SimulationLog(42).restore(bytes + "x"), IoError);
}

TEST(Digest, tells_texts_and_numbers_apart) {
  EXPECT_EQ(Digest().add("ab").value(), Digest().add("ab").value());
  EXPECT_NE(Digest().add("ab").value(), Digest().add("a").add("b").value());
  EXPECT_NE(Digest().add(1.0).value(), Digest().add(2.0).value());
}

}  // namespace
}  // namespace dendrofit
