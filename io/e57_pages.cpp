// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/e57_pages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace dendrofit {
namespace {

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = c & 1 ? 0x82f63b78u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}

constexpr auto kCrc = crc_table();

}  // namespace

std::uint32_t crc32c(const char* data, std::size_t size) {
  std::uint32_t c = ~std::uint32_t{0};
  for (std::size_t i = 0; i < size; ++i)
    c = kCrc[(c ^ static_cast<unsigned char>(data[i])) & 0xff] ^ (c >> 8);
  return ~c;
}

E57Pages::E57Pages(const FileBytes& bytes) : bytes_(bytes) {
  bytes.need(0, 48, "E57 header");
  const auto major = bytes.number<std::uint32_t>(8, "version");
  if (major != 1) fail_at_byte(bytes.path(), 8, "E57 version " + std::to_string(major) + "; 1 is known");
  const auto length = bytes.number<std::uint64_t>(16, "length");
  xml_offset_ = bytes.number<std::uint64_t>(24, "place of the XML");
  xml_length_ = bytes.number<std::uint64_t>(32, "length of the XML");
  page_ = bytes.number<std::uint64_t>(40, "page size");
  if (page_ < 64 || page_ > (1u << 24))
    fail_at_byte(bytes.path(), 40, "pages of " + std::to_string(page_) + " bytes; expected 1024");
  if (length > bytes.size())
    fail_at_byte(
        bytes.path(), bytes.size(),
        "the header claims " + std::to_string(length) + " bytes, the file ends before; it is truncated");
  pages_ = bytes.size() / page_;
  checked_.assign(pages_, 0);
}

std::uint64_t E57Pages::logical(std::uint64_t physical, const char* what) const {
  const std::uint64_t within = physical % page_;
  if (physical / page_ >= pages_ || within >= page_ - 4)
    fail_at_byte(bytes_.path(), std::min<std::uint64_t>(physical, bytes_.size()),
                 std::string("the ") + what + " cannot lie here; the file is damaged");
  return physical / page_ * (page_ - 4) + within;
}

std::string E57Pages::read(std::uint64_t logical, std::uint64_t count, const char* what) {
  const std::uint64_t content = page_ - 4;
  if (logical > logical_size() || count > logical_size() - logical)
    fail_at_byte(bytes_.path(), bytes_.size(),
                 std::string("the file ends before the ") + what + "; it is truncated or damaged");
  std::string out;
  out.reserve(count);
  while (count > 0) {
    const std::uint64_t page = logical / content;
    const std::uint64_t within = logical % content;
    const std::uint64_t part = std::min(count, content - within);
    check_page(page);
    out.append(bytes_.data() + page * page_ + within, part);
    logical += part;
    count -= part;
  }
  return out;
}

void E57Pages::check_page(std::uint64_t page) {
  if (checked_[page]) return;
  const char* from = bytes_.data() + page * page_;
  const auto stated = FileBytes::load<std::uint32_t>(from + page_ - 4, std::endian::big);
  if (crc32c(from, page_ - 4) != stated)
    fail_at_byte(bytes_.path(), page * page_,
                 "the checksum of this page is wrong; the file is damaged, copy it again");
  checked_[page] = 1;
}

E57Stream E57Stream::reals(Kind kind) {
  E57Stream s;
  s.kind_ = kind;
  s.bits_ = kind == Kind::single ? 32 : 64;
  return s;
}

E57Stream E57Stream::integers(std::int64_t lo, std::int64_t hi, double scale, double offset) {
  E57Stream s;
  s.kind_ = Kind::integer;
  s.lo_ = lo;
  s.bits_ = std::bit_width(static_cast<std::uint64_t>(hi) - static_cast<std::uint64_t>(lo));
  s.scale_ = scale;
  s.offset_ = offset;
  return s;
}

std::uint64_t E57Stream::available() const {
  if (bits_ == 0) return std::numeric_limits<std::uint64_t>::max();
  return (pending_.size() * 8 - bit_) / static_cast<std::uint64_t>(bits_);
}

double E57Stream::next() {
  const char* from = pending_.data() + bit_ / 8;
  if (kind_ != Kind::integer) {
    bit_ += static_cast<std::uint64_t>(bits_);
    return kind_ == Kind::single ? static_cast<double>(FileBytes::load<float>(from))
                                 : FileBytes::load<double>(from);
  }
  std::uint64_t value = 0;
  for (int got = 0; got < bits_;) {
    const auto byte = static_cast<unsigned char>(pending_[bit_ / 8]);
    const int skip = static_cast<int>(bit_ % 8);
    const int take = std::min(8 - skip, bits_ - got);
    value |= static_cast<std::uint64_t>((byte >> skip) & ((1 << take) - 1)) << got;
    got += take;
    bit_ += static_cast<std::uint64_t>(take);
  }
  const auto whole = static_cast<std::int64_t>(value + static_cast<std::uint64_t>(lo_));
  return static_cast<double>(whole) * scale_ + offset_;
}

void E57Stream::compact() {
  pending_.erase(0, bit_ / 8);
  bit_ %= 8;
}

}  // namespace dendrofit
