// SPDX-License-Identifier: GPL-3.0-or-later
// PCD 0.7: ascii, binary and binary_compressed (LZF).
#include "io/cloud_formats.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dendrofit {
namespace {

struct Field {
  std::string name;
  std::size_t size = 4;
  char type = 'F';
  std::size_t count = 1;
  std::size_t offset = 0;  ///< in a record
  std::size_t column = 0;  ///< first word of it in an ascii line
};

struct Header {
  std::vector<Field> fields;
  std::uint64_t points = 0;
  std::string data;
  std::uint64_t data_offset = 0;
  std::size_t lines = 0;
  std::size_t stride = 0;
  std::size_t columns = 0;
  const Field* find(std::string_view name) const {
    for (const Field& f : fields)
      if (f.name == name) return &f;
    return nullptr;
  }
};

Header read_header(const FileBytes& bytes) {
  const std::string_view view = bytes.view();
  Header h;
  std::optional<std::uint64_t> width;
  std::optional<std::uint64_t> height;
  std::optional<std::uint64_t> points;
  std::size_t at = 0;
  while (h.data.empty()) {
    const std::size_t end = view.find('\n', at);
    ++h.lines;
    const auto fail = [&](const std::string& what) { fail_at_line(bytes.path(), h.lines, what); };
    if (end == std::string_view::npos || end - at > 4096)
      fail("the header has no DATA line; the file is truncated or no PCD");
    const std::vector<std::string_view> words = words_of(view.substr(at, end - at));
    at = end + 1;
    if (words.empty() || words[0].front() == '#' || words[0] == "VERSION" || words[0] == "VIEWPOINT")
      continue;
    const auto whole = [&](std::size_t k) {
      std::int64_t value = 0;
      if (k >= words.size() || !integer_from(words[k], value) || value < 0)
        fail(std::string(words[0]) + ": a whole number expected" +
             (k < words.size() ? ", " + shown(words[k]) + " found" : ""));
      return static_cast<std::uint64_t>(value);
    };
    const bool per_field = words[0] == "SIZE" || words[0] == "TYPE" || words[0] == "COUNT";
    if (per_field && words.size() != h.fields.size() + 1)
      fail(std::string(words[0]) + " has " + std::to_string(words.size() - 1) + " entries for " +
           std::to_string(h.fields.size()) + " FIELDS");
    if (words[0] == "FIELDS" || words[0] == "COLUMNS") {
      h.fields.clear();
      for (std::size_t k = 1; k < words.size(); ++k) h.fields.push_back({.name = lower(words[k])});
    } else if (words[0] == "SIZE") {
      for (std::size_t k = 0; k < h.fields.size(); ++k) h.fields[k].size = whole(k + 1);
    } else if (words[0] == "TYPE") {
      for (std::size_t k = 0; k < h.fields.size(); ++k) h.fields[k].type = words[k + 1].front();
    } else if (words[0] == "COUNT") {
      for (std::size_t k = 0; k < h.fields.size(); ++k) h.fields[k].count = whole(k + 1);
    } else if (words[0] == "WIDTH") {
      width = whole(1);
    } else if (words[0] == "HEIGHT") {
      height = whole(1);
    } else if (words[0] == "POINTS") {
      points = whole(1);
    } else if (words[0] == "DATA") {
      h.data = words.size() > 1 ? std::string(words[1]) : "";
      if (h.data != "ascii" && h.data != "binary" && h.data != "binary_compressed")
        fail("DATA " + shown(h.data) + "; expected ascii, binary or binary_compressed");
    } else {
      fail(shown(words[0]) +
           " found; expected a PCD header line (FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, POINTS, DATA)");
    }
  }
  const auto fail = [&](const std::string& what) { fail_at_line(bytes.path(), h.lines, what); };
  h.data_offset = at;
  for (Field& f : h.fields) {
    const bool known =
        (f.type == 'F' && (f.size == 4 || f.size == 8)) ||
        ((f.type == 'I' || f.type == 'U') && (f.size == 1 || f.size == 2 || f.size == 4 || f.size == 8));
    if (!known)
      fail("field '" + f.name + "' of type " + shown(std::string(1, f.type)) + " and size " +
           std::to_string(f.size) + " is not known");
    if (f.count > 100000)
      fail("field '" + f.name + "' with COUNT " + std::to_string(f.count) + "; the header is damaged");
    f.offset = h.stride;
    f.column = h.columns;
    h.stride += f.size * f.count;
    h.columns += f.count;
  }
  if (width && height && *height > 0 && *width > 1'000'000'000'000ULL / *height)
    fail("WIDTH times HEIGHT is more than any file holds; the header is damaged");
  const std::optional<std::uint64_t> area = width && height ? std::optional(*width * *height) : std::nullopt;
  if (points && area && *points != *area)
    fail("POINTS " + std::to_string(*points) + " is not WIDTH times HEIGHT, " + std::to_string(*area));
  if (!points && !area) fail("neither POINTS nor WIDTH and HEIGHT in the header");
  h.points = points ? *points : *area;
  for (const char* name : {"x", "y", "z"}) {
    const Field* f = h.find(name);
    if (!f) fail(std::string("no field '") + name + "' in FIELDS; expected x, y and z");
    if (f->count != 1)
      fail(std::string("field '") + name + "' has COUNT " + std::to_string(f->count) + "; expected 1");
  }
  return h;
}

double number_at(const Field& f, const char* from) {
  if (f.type == 'F')
    return f.size == 4 ? static_cast<double>(FileBytes::load<float>(from)) : FileBytes::load<double>(from);
  const bool is_signed = f.type == 'I';
  switch (f.size) {
    case 1:
      return is_signed ? static_cast<double>(static_cast<std::int8_t>(*from))
                       : static_cast<std::uint8_t>(*from);
    case 2:
      return is_signed ? static_cast<double>(FileBytes::load<std::int16_t>(from))
                       : FileBytes::load<std::uint16_t>(from);
    case 4:
      return is_signed ? static_cast<double>(FileBytes::load<std::int32_t>(from))
                       : FileBytes::load<std::uint32_t>(from);
    default:
      return is_signed ? static_cast<double>(FileBytes::load<std::int64_t>(from))
                       : static_cast<double>(FileBytes::load<std::uint64_t>(from));
  }
}

// LZF: literal runs and back references, told apart by the control byte's three top bits.
std::string unpack_lzf(const FileBytes& bytes, std::uint64_t from, std::size_t packed, std::size_t unpacked) {
  const auto* in = reinterpret_cast<const unsigned char*>(bytes.data()) + from;
  const unsigned char* const end = in + packed;
  std::string out;
  out.reserve(unpacked);
  const auto fail = [&](const char* what) {
    fail_at_byte(bytes.path(), static_cast<std::uint64_t>(reinterpret_cast<const char*>(in) - bytes.data()),
                 std::string("compressed points: ") + what + "; the file is damaged, copy it again");
  };
  while (in < end) {
    std::size_t control = *in++;
    if (control < 32) {
      const std::size_t length = control + 1;
      if (static_cast<std::size_t>(end - in) < length) fail("a run of bytes goes beyond their end");
      out.append(reinterpret_cast<const char*>(in), length);
      in += length;
    } else {
      std::size_t length = control >> 5;
      if (length == 7) {
        if (in >= end) fail("they end inside a reference");
        length += *in++;
      }
      if (in >= end) fail("they end inside a reference");
      const std::size_t back = ((control & 31) << 8) + *in++ + 1;
      if (back > out.size()) fail("a reference to before their start");
      const std::size_t start = out.size() - back;
      for (std::size_t k = 0; k < length + 2; ++k) out += out[start + k];
    }
    if (out.size() > unpacked) fail("more bytes than the header says");
  }
  if (out.size() != unpacked) fail("fewer bytes than the header says");
  return out;
}

// Takes the numbers of one point and keeps them; a point without a return (all three NaN) is left out.
class Sink {
 public:
  Sink(const Header& header, Progress& progress)
      : intensity_(header.find("intensity")),
        class_(find_class(header)),
        ticker_(progress, "reading", static_cast<double>(header.points)) {
    x_ = header.find("x");
    y_ = header.find("y");
    z_ = header.find("z");
  }

  template <class Value, class Fail>
  void add(const Value& value, const Fail& fail) {
    ticker_.tick();
    const Vec3 p(value(*x_), value(*y_), value(*z_));
    if (std::isnan(p.x()) && std::isnan(p.y()) && std::isnan(p.z())) return;
    if (!p.allFinite()) fail("a coordinate that is not a finite number; remove the point");
    cloud.points.push_back(p);
    if (intensity_) cloud.intensity.push_back(static_cast<float>(value(*intensity_)));
    if (class_) {
      const double c = value(*class_);
      cloud.classification.push_back(c >= 0 && c <= 255 ? static_cast<std::uint8_t>(c) : std::uint8_t{0});
    }
  }

  PointCloud cloud;

 private:
  static const Field* find_class(const Header& header) {
    for (const char* name : {"classification", "class", "label"})
      if (const Field* f = header.find(name)) return f;
    return nullptr;
  }
  const Field* x_;
  const Field* y_;
  const Field* z_;
  const Field* intensity_;
  const Field* class_;
  PointTicker ticker_;
};

void read_ascii(const FileBytes& bytes, const Header& h, Sink& sink) {
  const std::string_view view = bytes.view();
  std::size_t at = h.data_offset;
  std::size_t line = h.lines;
  std::vector<double> values(h.columns);
  for (std::uint64_t i = 0; i < h.points;) {
    if (at >= view.size())
      fail_at_line(bytes.path(), line,
                   "the header claims " + std::to_string(h.points) + " points, the file ends after " +
                       std::to_string(i) + "; it is truncated");
    const std::size_t end = std::min(view.find('\n', at), view.size());
    std::string_view rest = trimmed(view.substr(at, end - at));
    at = end + 1;
    ++line;
    if (rest.empty()) continue;
    for (double& value : values) {
      const char* stop = parse_number(rest.data(), rest.data() + rest.size(), value);
      const auto used = stop ? static_cast<std::size_t>(stop - rest.data()) : 0;
      if (!stop || (used < rest.size() && rest[used] != ' ' && rest[used] != '\t'))
        fail_at_line(bytes.path(), line,
                     rest.empty()
                         ? "fewer than the " + std::to_string(h.columns) + " numbers the header says"
                         : shown(rest.substr(0, rest.find_first_of(" \t"))) + " found, a number expected");
      rest = trimmed(rest.substr(used));
    }
    if (!rest.empty())
      fail_at_line(bytes.path(), line,
                   "more than the " + std::to_string(h.columns) + " numbers the header says");
    sink.add([&](const Field& f) { return values[f.column]; },
             [&](const char* what) { fail_at_line(bytes.path(), line, what); });
    ++i;
  }
}

}  // namespace

PointCloud read_pcd(const FileBytes& bytes, Progress& progress) {
  const Header h = read_header(bytes);
  Sink sink(h, progress);
  if (h.data == "ascii") {
    read_ascii(bytes, h, sink);
    return std::move(sink.cloud);
  }
  const auto claim = [&](std::uint64_t fit) {
    fail_at_byte(bytes.path(), bytes.size(),
                 "the header claims " + std::to_string(h.points) + " points, the file holds " +
                     std::to_string(fit) + "; it is truncated or its header damaged");
  };
  if (h.data == "binary") {
    const std::uint64_t fit = (bytes.size() - h.data_offset) / h.stride;
    if (h.points > fit) claim(fit);
    for (std::uint64_t i = 0; i < h.points; ++i) {
      const std::uint64_t record = h.data_offset + i * h.stride;
      sink.add([&](const Field& f) { return number_at(f, bytes.data() + record + f.offset); },
               [&](const char* what) { fail_at_byte(bytes.path(), record, what); });
    }
    return std::move(sink.cloud);
  }
  const auto packed = bytes.number<std::uint32_t>(h.data_offset, "compressed size");
  const auto unpacked = bytes.number<std::uint32_t>(h.data_offset + 4, "uncompressed size");
  bytes.need(h.data_offset + 8, packed, "compressed points");
  // LZF makes at most 264 bytes of 3.
  if (unpacked / 88 > packed || h.points != unpacked / h.stride || h.points * h.stride != unpacked)
    claim(unpacked / h.stride);
  const std::string data = unpack_lzf(bytes, h.data_offset + 8, packed, unpacked);
  for (std::uint64_t i = 0; i < h.points; ++i)  // field by field: all x, then all y, ...
    sink.add(
        [&](const Field& f) {
          return number_at(f, data.data() + f.offset * h.points + i * f.size * f.count);
        },
        [&](const char* what) {
          fail_at_byte(bytes.path(), h.data_offset, "point " + std::to_string(i + 1) + ": " + what);
        });
  return std::move(sink.cloud);
}

}  // namespace dendrofit
