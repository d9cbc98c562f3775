// SPDX-License-Identifier: GPL-3.0-or-later
// Small hand-made things to write and read, and a folder that goes away.
#pragma once

#include "core/errors.h"
#include "core/foliage.h"
#include "core/point_cloud.h"
#include "core/random.h"
#include "core/tree.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace dendrofit::test {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("dendrofit_io_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Writes a file there and returns its path.
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string content_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A stem of three cylinders, a branch of two on its second, a twig on that, and a lone bush: two roots,
/// order 0 to 2.
inline Tree sample_tree(const Vec3& shift = Vec3::Zero()) {
  Tree tree;
  tree.origin_shift = shift;
  const double nan = std::nan("");
  using Q = RadiusQuality;
  tree.add({{0.1, 0.2, 0.3}, {0.11, 0.21, 1.3}, -1, 0.1, 0, 0, -1, Q::measured, 0.001});
  tree.add({{0.11, 0.21, 1.3}, {0.1, 0.3, 2.0 / 3 + 2}, 0, 0.09, 0, 0, -1, Q::measured, nan});
  tree.add({{0.1, 0.3, 2.0 / 3 + 2}, {0.13, 0.27, 4.1}, 1, 1.0 / 15, 0, 0, -1, Q::interpolated, nan});
  tree.add({{0.2, 0.31, 2.0}, {1.0 / 3, 0.9, 2.5}, 1, 0.03, 1, 1, -1, Q::allometric, 1e-5});
  tree.add({{1.0 / 3, 0.9, 2.5}, {0.4, 1.7, 2.7}, 3, 0.02, 1, 1, -1, Q::measured, nan});
  tree.add({{0.35, 0.95, 2.52}, {0.8, 1.0, 2.51}, 3, 0.004, 2, 2, -1, Q::extrapolated, nan});
  tree.add({{3.0, 0.2, 0.25}, {3.0, 0.2, 0.75}, -1, 0.012, 3, 0, -1, Q::measured, nan});
  tree.validate();
  return tree;
}

/// Many short cylinders at every angle, for what goes wrong one time in a hundred.
inline Tree random_tree(std::size_t nodes, const Vec3& shift, std::uint64_t seed = 7) {
  Random random(seed);
  Tree tree;
  tree.origin_shift = shift;
  std::int32_t axes = 1;
  std::vector<char> continued(nodes, 0);
  for (std::size_t i = 0; i < nodes; ++i) {
    TreeNode node;
    node.radius = random.uniform(0.001, 0.2);
    if (i == 0) {
      node.start = Vec3(random.uniform(), random.uniform(), random.uniform());
    } else {
      node.parent = static_cast<std::int32_t>(random.below(i));
      const auto p = static_cast<std::size_t>(node.parent);
      const bool goes_on = !continued[p];
      continued[p] = 1;
      node.start =
          goes_on ? tree.end[p] : Vec3(tree.start[p] + random.uniform() * (tree.end[p] - tree.start[p]));
      node.axis = goes_on ? tree.axis[p] : axes++;
      node.order = tree.order[p] + (goes_on ? 0 : 1);
    }
    node.end = node.start + random.uniform(0.001, 0.5) * random.direction();
    tree.add(node);
  }
  tree.validate();
  return tree;
}

inline PointCloud sample_cloud(std::size_t points = 50, const Vec3& shift = Vec3::Zero(),
                               bool attributes = true) {
  Random random(3);
  PointCloud cloud;
  cloud.origin_shift = shift;
  for (std::size_t i = 0; i < points; ++i) {
    cloud.points.emplace_back(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(0, 9));
    if (!attributes) continue;
    cloud.intensity.push_back(static_cast<float>(random.below(4000)));
    cloud.classification.push_back(static_cast<std::uint8_t>(random.below(19)));
  }
  return cloud;
}

inline Foliage sample_foliage(const Vec3& shift = Vec3::Zero()) {
  Foliage foliage;
  foliage.origin_shift = shift;
  foliage.species = "Acer, \"Norway\"";
  foliage.shapes.push_back(
      {"diamond", {{0, 0, 0}, {-0.3, 0.5, 0}, {0, 1, 0}, {0.3, 0.5, 0}}, {{0, 3, 1}, {1, 3, 2}}});
  for (int i = 0; i < 5; ++i) {
    Leaf leaf;
    leaf.origin = Vec3(0.1 * i, 0.2, 2 + 0.1 * i);
    leaf.petiole_foot = leaf.origin - Vec3(0, 0.02, 0);
    const double angle = 0.5 * i;
    leaf.direction = Vec3(std::cos(angle), std::sin(angle), 0);
    leaf.length_m = 0.05 + 0.01 * i;
    leaf.node = i;
    foliage.leaves.push_back(leaf);
  }
  return foliage;
}

/// The message of the IoError (or InputError) that `read` throws; a failure when it throws none or another.
inline std::string refusal(const std::function<void()>& read) {
  try {
    read();
  } catch (const IoError& error) {
    return error.what();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "it was read without complaint";
  return {};
}

}  // namespace dendrofit::test
