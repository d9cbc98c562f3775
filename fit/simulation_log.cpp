// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/simulation_log.h"

#include "core/errors.h"

#include <bit>
#include <cstring>

namespace dendrofit {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are little endian");
constexpr std::string_view kMagic = "dendrofit fit checkpoint 1\n";

template <class Value>
void put(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

template <class Value>
Value take(std::string_view& bytes) {
  if (bytes.size() < sizeof(Value)) throw IoError("the checkpoint is damaged: it ends too early");
  Value value;
  std::memcpy(&value, bytes.data(), sizeof(Value));
  bytes.remove_prefix(sizeof(Value));
  return value;
}

}  // namespace

const std::vector<double>* SimulationLog::find(std::uint64_t key) const {
  const auto found = known_.find(key);
  return found == known_.end() ? nullptr : &found->second;
}

void SimulationLog::add(std::uint64_t key, std::vector<double> descriptors) {
  known_.emplace(key, std::move(descriptors));
}

std::string SimulationLog::bytes(double seconds) const {
  std::string bytes(kMagic);
  put(bytes, identity_);
  put(bytes, seconds);
  put(bytes, static_cast<std::uint64_t>(known_.size()));
  for (const auto& [key, values] : known_) {
    put(bytes, key);
    put(bytes, static_cast<std::uint32_t>(values.size()));
    for (const double value : values) put(bytes, value);
  }
  return bytes;
}

void SimulationLog::restore(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) throw IoError("this is no checkpoint of a fit");
  bytes.remove_prefix(kMagic.size());
  if (take<std::uint64_t>(bytes) != identity_)
    throw InputError(
        "the checkpoint belongs to another fit: resume with the same tree, options and seed, or start anew "
        "without --resume");
  earlier_seconds_ = take<double>(bytes);
  const auto count = take<std::uint64_t>(bytes);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto key = take<std::uint64_t>(bytes);
    const auto size = take<std::uint32_t>(bytes);
    if (size > bytes.size() / sizeof(double)) throw IoError("the checkpoint is damaged: it ends too early");
    std::vector<double> values(size);
    for (double& value : values) value = take<double>(bytes);
    known_.emplace(key, std::move(values));
  }
  if (!bytes.empty()) throw IoError("the checkpoint is damaged: it goes on after its end");
}

Digest& Digest::add(std::string_view text) {
  for (const char c : text) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  hash_ = (hash_ ^ 0xff) * 0x100000001b3ULL;
  return *this;
}

Digest& Digest::add(double value) {
  std::string bytes;
  put(bytes, value);
  return add(bytes);
}

}  // namespace dendrofit
