// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/leaf_laws.h"

#include "cli/parse.h"
#include "core/errors.h"

#include <gtest/gtest.h>

namespace dendrofit::cli {
namespace {

TEST(LeafLaws, AreReadAsTyped) {
  const UnitDistribution beta = unit_distribution_from("beta:2,3", "--x");
  EXPECT_EQ(beta.kind, UnitDistribution::Kind::beta);
  EXPECT_EQ(beta.a, 2);
  EXPECT_EQ(beta.b, 3);
  EXPECT_EQ(unit_distribution_from("uniform", "--x").kind, UnitDistribution::Kind::uniform);
  EXPECT_EQ(unit_distribution_from("table:1,0,3", "--x").table, (std::vector<double>{1, 0, 3}));
  const UnitDistribution both = unit_distribution_from("0.3*beta:2,8+0.7*weibull:0.6,2", "--x");
  ASSERT_EQ(both.kind, UnitDistribution::Kind::mixture);
  EXPECT_EQ(both.table, (std::vector<double>{0.3, 0.7}));
  EXPECT_EQ(both.parts[1].kind, UnitDistribution::Kind::weibull);
}

TEST(LeafLaws, InclinationsTakeTheirParameters) {
  EXPECT_EQ(inclination_law_from("spherical", "--i").kind, InclinationLaw::Kind::spherical);
  const InclinationLaw ellipsoid = inclination_law_from("ellipsoidal:1.5", "--i");
  EXPECT_EQ(ellipsoid.kind, InclinationLaw::Kind::ellipsoidal);
  EXPECT_EQ(ellipsoid.a, 1.5);
  EXPECT_EQ(inclination_law_from("table:5,9,4", "--i").table.size(), 3U);
  EXPECT_THROW(inclination_law_from("flat", "--i"), UsageError);
  EXPECT_THROW(inclination_law_from("planophile:1", "--i"), UsageError);
  EXPECT_THROW(inclination_law_from("ellipsoidal:-1", "--i"), InputError);
}

TEST(LeafLaws, AProfileNamesItsPlaceOnce) {
  LeafProfile profile;
  set_profile("height=beta:2,3", profile);
  set_profile("tip-distance=uniform", profile);
  ASSERT_TRUE(profile.height && profile.tip_distance);
  EXPECT_FALSE(profile.compass);
  EXPECT_THROW(set_profile("height=uniform", profile), UsageError);
  for (const char* wrong : {"depth=uniform", "height", "compass=", "compass=beta:2", "compass=beta:2,x",
                            "compass=gauss:1,2", "compass=table:", "compass=x*uniform"})
    EXPECT_THROW(set_profile(wrong, profile), UsageError) << wrong;
  EXPECT_THROW(set_profile("compass=beta:0,2", profile), InputError);
}

}  // namespace
}  // namespace dendrofit::cli
