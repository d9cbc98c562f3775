// SPDX-License-Identifier: GPL-3.0-or-later
// A bank of prior simulations as bytes: a text line, then a deflated block of
//   u32 draws, u32 columns, u32 stamp length, u32 truncations, u32 descriptors, f32 stamp[], for each
//   truncation f32 covariance[descriptors^2], and for each column f32 lo, f32 hi, u16 value[]
// (little endian; value 65535: missing, else lo + value / 65534 * (hi - lo)).
#include "core/errors.h"
#include "fit/prior_bank.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <zlib.h>

namespace dendrofit {
namespace {

static_assert(std::endian::native == std::endian::little, "bank files are little endian");
constexpr std::string_view kMagic = "dendrofit prior bank 2\n";
constexpr std::uint16_t kMissing = 65535;
constexpr double kSteps = 65534;
constexpr std::size_t kLargest = 1u << 28;

template <class Value>
void put(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}
  template <class Value>
  Value take() {
    if (bytes_.size() < sizeof(Value)) fail("ends too early");
    Value value;
    std::memcpy(&value, bytes_.data(), sizeof(Value));
    bytes_.remove_prefix(sizeof(Value));
    return value;
  }
  bool done() const { return bytes_.empty(); }
  std::size_t left() const { return bytes_.size(); }
  [[noreturn]] void fail(const std::string& what) const {
    throw IoError(name_ + ": " + what + "; it is no bank of prior simulations (scripts/make_bank makes one)");
  }

 private:
  std::string_view bytes_;
  const std::string& name_;
};

}  // namespace

std::string encode_bank(const PriorBank& bank) {
  const Eigen::MatrixXf& values = bank.descriptors;
  std::string plain;
  put(plain, static_cast<std::uint32_t>(values.rows()));
  put(plain, static_cast<std::uint32_t>(values.cols()));
  put(plain, static_cast<std::uint32_t>(bank.stamp.size()));
  const Eigen::Index side = bank.noise.empty() ? 0 : bank.noise.front().covariance.rows();
  put(plain, static_cast<std::uint32_t>(bank.noise.size()));
  put(plain, static_cast<std::uint32_t>(side));
  for (const float s : bank.stamp) put(plain, s);
  for (const SeedNoise& noise : bank.noise)
    for (const double value : noise.covariance.reshaped()) put(plain, static_cast<float>(value));
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    float lo = std::numeric_limits<float>::infinity(), hi = -lo;
    for (const float v : values.col(j)) {
      if (!std::isfinite(v)) continue;
      lo = std::min(lo, v);
      hi = std::max(hi, v);
    }
    put(plain, lo);
    put(plain, hi);
    const double span = hi > lo ? static_cast<double>(hi) - lo : 1.0;
    for (const float v : values.col(j))
      put(plain,
          std::isfinite(v) ? static_cast<std::uint16_t>(std::lround((v - lo) / span * kSteps)) : kMissing);
  }
  uLongf size = compressBound(plain.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
                plain.size(), 9) != Z_OK)
    throw IoError("the bank cannot be compressed: out of memory");
  packed.resize(size);
  std::string bytes(kMagic);
  put(bytes, static_cast<std::uint32_t>(plain.size()));
  return bytes + packed;
}

PriorBank decode_bank(std::string_view bytes, const std::string& name) {
  Reader head(bytes, name);
  if (!bytes.starts_with(kMagic)) head.fail("starts otherwise");
  bytes.remove_prefix(kMagic.size());
  Reader sized(bytes, name);
  const std::size_t size = sized.take<std::uint32_t>();
  bytes.remove_prefix(sizeof(std::uint32_t));
  if (size > kLargest) head.fail("claims to hold more than a bank can");
  std::string plain(size, '\0');
  uLongf got = size;
  if (uncompress(reinterpret_cast<Bytef*>(plain.data()), &got, reinterpret_cast<const Bytef*>(bytes.data()),
                 bytes.size()) != Z_OK ||
      got != size)
    head.fail("is damaged");

  Reader in(plain, name);
  const auto rows = static_cast<std::size_t>(in.take<std::uint32_t>());
  const auto columns = static_cast<std::size_t>(in.take<std::uint32_t>());
  const auto stamps = static_cast<std::size_t>(in.take<std::uint32_t>());
  const auto levels = static_cast<std::size_t>(in.take<std::uint32_t>());
  const auto side = static_cast<std::size_t>(in.take<std::uint32_t>());
  if (columns > 100000 || side > columns || levels > columns ||
      in.left() != 4 * (stamps + levels * side * side) + columns * (8 + 2 * rows))
    head.fail("does not hold what it announces");
  PriorBank bank;
  for (std::size_t i = 0; i < stamps; ++i) bank.stamp.push_back(in.take<float>());
  for (std::size_t level = 0; level < levels; ++level) {
    const auto n = static_cast<Eigen::Index>(side);
    Eigen::MatrixXd covariance(n, n);
    for (double& value : covariance.reshaped()) value = in.take<float>();
    bank.noise.push_back({covariance});
  }
  bank.descriptors.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  for (Eigen::Index j = 0; j < bank.descriptors.cols(); ++j) {
    const auto lo = in.take<float>();
    const auto hi = in.take<float>();
    const double span = hi > lo ? static_cast<double>(hi) - lo : 1.0;
    for (float& v : bank.descriptors.col(j)) {
      const auto step = in.take<std::uint16_t>();
      v = step == kMissing ? std::numeric_limits<float>::quiet_NaN()
                           : static_cast<float>(lo + step / kSteps * span);
    }
  }
  return bank;
}

}  // namespace dendrofit
