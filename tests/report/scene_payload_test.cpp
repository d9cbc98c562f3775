// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/scene_payload.h"

#include "tests/report/sample.h"

#include <cstring>
#include <regex>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Reads an array back by the names that lead to it, e.g. {"regrown", "parent"}.
template <class T>
std::vector<T> array_of(const ScenePayload& payload, const std::vector<std::string>& path) {
  std::size_t at = 0;
  for (const std::string& name : path) {
    at = payload.directory.find("\"" + name + "\":", at);
    EXPECT_NE(at, std::string::npos) << name;
    at += name.size() + 3;
  }
  std::smatch match;
  const std::string rest = payload.directory.substr(at, 120);
  EXPECT_TRUE(std::regex_search(rest, match, std::regex("\"offset\":([0-9]+),\"count\":([0-9]+)")));
  const std::size_t offset = std::stoul(match[1]);
  std::vector<T> values(std::stoul(match[2]));
  EXPECT_EQ(offset % 4, 0u);
  EXPECT_LE(offset + values.size() * sizeof(T), payload.binary.size());
  std::memcpy(values.data(), payload.binary.data() + offset, values.size() * sizeof(T));
  return values;
}

std::vector<double> numbers_of(const ScenePayload& payload, const std::string& layer,
                               const std::string& name) {
  std::size_t at = payload.directory.find("\"" + layer + "\":");
  at = payload.directory.find("\"" + name + "\":[", at) + name.size() + 4;
  std::vector<double> out;
  const std::string list = payload.directory.substr(at, payload.directory.find(']', at) - at);
  for (std::size_t from = 0; from < list.size();
       from = list.find(',', from) == std::string::npos ? list.size() : list.find(',', from) + 1)
    out.push_back(std::stod(list.substr(from)));
  return out;
}

TEST(ScenePayload, NothingGivesAnEmptyDirectory) {
  const ScenePayload payload = scene_payload({}, {});
  EXPECT_TRUE(payload.binary.empty());
  EXPECT_EQ(payload.directory, "{}");
  const Tree none;
  const PointCloud empty;
  ReportData data;
  data.model = &none;
  data.scan = &empty;
  EXPECT_EQ(scene_payload(data, {}).directory, "{}");
}

TEST(ScenePayload, CylindersComeBackWithinASixteenBitStep) {
  const Tree tree = test::branching_tree(3, 1, {486000.25, 5432000.5, 412.75});
  ReportData data;
  data.model = &tree;
  const ScenePayload payload = scene_payload(data, {});
  const auto steps = array_of<std::uint16_t>(payload, {"model", "ends", "data"});
  const auto id = array_of<std::int32_t>(payload, {"model", "id"});
  const auto lo = numbers_of(payload, "model", "lo");
  const auto step = numbers_of(payload, "model", "step");
  ASSERT_EQ(steps.size(), 6 * tree.size());
  ASSERT_EQ(id.size(), tree.size());
  for (std::size_t k = 0; k < id.size(); ++k) {
    const auto i = static_cast<std::size_t>(id[k]) - 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto axis = static_cast<Eigen::Index>(c);
      EXPECT_NEAR(lo[c] + step[c] * steps[6 * k + c], tree.start[i][axis] - tree.start[0][axis], step[c]);
      EXPECT_NEAR(lo[c] + step[c] * steps[6 * k + 3 + c], tree.end[i][axis] - tree.start[0][axis], step[c]);
    }
  }
  EXPECT_LT(*std::max_element(step.begin(), step.end()), 0.0002);
}

TEST(ScenePayload, WoodComesInOrderOfBirthAndParentsFollow) {
  const Tree tree = test::branching_tree(3, 1);
  ReportData data;
  data.regrown = &tree;
  const ScenePayload payload = scene_payload(data, {});
  const auto birth = array_of<std::int16_t>(payload, {"regrown", "birth"});
  const auto parent = array_of<std::int32_t>(payload, {"regrown", "parent"});
  const auto id = array_of<std::int32_t>(payload, {"regrown", "id"});
  EXPECT_TRUE(std::is_sorted(birth.begin(), birth.end()));
  for (std::size_t k = 0; k < parent.size(); ++k) {
    const std::int32_t expected = tree.parent[static_cast<std::size_t>(id[k]) - 1];
    if (expected < 0)
      EXPECT_EQ(parent[k], -1);
    else
      EXPECT_EQ(id[static_cast<std::size_t>(parent[k])] - 1, expected);
  }
}

TEST(ScenePayload, ThinsTheScanEvenlyToItsLimit) {
  const Tree tree = test::branching_tree(2, 1);
  PointCloud cloud = test::scattered_scan(tree, 5000);
  ReportData data;
  data.scan = &cloud;
  ReportOptions options;
  options.max_scan_points = 1000;
  const ScenePayload payload = scene_payload(data, options);
  EXPECT_EQ(payload.scan_shown, 1000u);
  EXPECT_EQ(array_of<std::uint16_t>(payload, {"scan", "data"}).size(), 3000u);
  EXPECT_EQ(payload.binary, scene_payload(data, options).binary);
  options.max_scan_points = 1'000'000;
  EXPECT_EQ(scene_payload(data, options).scan_shown, cloud.size());
}

TEST(ScenePayload, ShootsComeWithTheirLeavesAndOfVeryManyOnlySome) {
  const Tree tree = test::branching_tree(3, 1, {486000.25, 5432000.5, 412.75});
  Foliage foliage = test::diamond_leaves(tree, 50);
  ReportData data;
  data.model = &tree;
  data.foliage = &foliage;
  EXPECT_EQ(scene_payload(data, {}).directory.find("shoots"), std::string::npos);
  foliage.twigs.origin_shift = tree.origin_shift;
  const auto add_shoots = [&](int count) {
    for (int k = 0; k < count; ++k) {
      TreeNode node;
      node.start = Vec3(0.001 * (k % 1000), 0, 2);
      node.end = node.start + Vec3(0, 0.1, 0);
      node.radius = 0.002;
      node.axis = k;
      const std::int32_t parent = foliage.twigs.add(node);
      node.start = node.end;
      node.end = node.start + Vec3(0, 0.1, 0.02);
      node.parent = parent;
      foliage.twigs.add(node);
    }
  };
  add_shoots(30);
  ScenePayload payload = scene_payload(data, {});
  EXPECT_EQ(array_of<float>(payload, {"shoots", "radius"}).size(), 60U);
  EXPECT_EQ(array_of<std::uint16_t>(payload, {"shoots", "ends", "data"}).size(), 360U);
  EXPECT_EQ(array_of<std::uint16_t>(payload, {"leaves", "feet", "data"}).size(), 150U);
  foliage.twigs = Tree();
  foliage.twigs.origin_shift = tree.origin_shift;
  add_shoots(50000);
  payload = scene_payload(data, {});
  EXPECT_EQ(array_of<float>(payload, {"shoots", "radius"}).size(), 50000U);  // every other shoot, whole
}

}  // namespace
}  // namespace dendrofit
