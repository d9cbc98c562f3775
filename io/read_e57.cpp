// SPDX-License-Identifier: GPL-3.0-or-later
// E57 (ASTM E2807): all scans of a file, brought to common coordinates by their poses.
#include "io/cloud_formats.h"
#include "io/e57_pages.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>
#include <pugixml.hpp>

namespace dendrofit {
namespace {

// The fields that matter here, in the order of `field_of`.
enum Field : int {
  kX,
  kY,
  kZ,
  kRange,
  kAzimuth,
  kElevation,
  kInvalid,
  kSphericalInvalid,
  kIntensity,
  kClass,
  kFields
};
constexpr const char* kFieldNames[kFields] = {"cartesianX",
                                              "cartesianY",
                                              "cartesianZ",
                                              "sphericalRange",
                                              "sphericalAzimuth",
                                              "sphericalElevation",
                                              "cartesianInvalidState",
                                              "sphericalInvalidState",
                                              "intensity",
                                              "classification"};

class Reader {
 public:
  Reader(const FileBytes& bytes, Progress& progress) : bytes_(bytes), pages_(bytes), progress_(progress) {}

  PointCloud read() {
    const std::string text =
        pages_.read(pages_.logical(pages_.xml_offset(), "XML"), pages_.xml_length(), "XML");
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
    if (!parsed)
      fail("its XML is damaged: " + std::string(parsed.description()) + " at its byte " +
           std::to_string(parsed.offset));
    const pugi::xml_node root = document.child("e57Root");
    if (!root) fail("its XML has no e57Root");
    cloud_.crs_wkt = root.child_value("coordinateMetadata");
    for (const pugi::xml_node scan : root.child("data3D").children("vectorChild")) read_scan(scan);
    if (with_intensity_ < cloud_.size()) cloud_.intensity.clear();
    if (with_class_ < cloud_.size()) cloud_.classification.clear();
    return std::move(cloud_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    fail_in_file(bytes_.path(), "scan " + std::to_string(scan_) + ": " + what);
  }

  double number(const pugi::xml_node& node, const char* child, double otherwise) const {
    const pugi::xml_node value = node.child(child);
    const std::string_view text = value.child_value();
    if (!value || trimmed(text).empty()) return value ? 0 : otherwise;  // an empty element is zero
    return parsed(text, child);
  }
  double attribute(const pugi::xml_node& node, const char* name, double otherwise) const {
    const pugi::xml_attribute value = node.attribute(name);
    return value ? parsed(value.value(), name) : otherwise;
  }
  double parsed(std::string_view text, const char* name) const {
    double value = 0;
    if (!number_from(text, value) || !std::isfinite(value))
      fail(std::string(name) + " " + shown(text) + "; a number expected");
    return value;
  }
  std::int64_t whole(const pugi::xml_node& node, const char* name, std::int64_t otherwise) const {
    const pugi::xml_attribute value = node.attribute(name);
    if (!value) return otherwise;
    std::int64_t result = 0;
    const std::string_view text = value.value();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result);
    if (error != std::errc() || end != text.data() + text.size())
      fail(std::string(name) + " " + shown(text) + "; a whole number expected");
    return result;
  }

  void read_pose(const pugi::xml_node& scan) {
    const pugi::xml_node pose = scan.child("pose");
    const pugi::xml_node q = pose.child("rotation");
    const pugi::xml_node t = pose.child("translation");
    turn_ = Eigen::Quaterniond(number(q, "w", 1), number(q, "x", 0), number(q, "y", 0), number(q, "z", 0));
    if (std::abs(turn_.norm() - 1) > 1e-3) fail("its pose's rotation is no unit quaternion");
    turn_.normalize();
    shift_ = Vec3(number(t, "x", 0), number(t, "y", 0), number(t, "z", 0));
    if (pose) cloud_.scanner_positions.push_back(shift_);
  }

  E57Stream stream_of(const pugi::xml_node& field) const {
    const std::string_view type = field.attribute("type").value();
    if (type == "Float") {
      const bool single = std::string_view(field.attribute("precision").value()) == "single";
      return E57Stream::reals(single ? E57Stream::Kind::single : E57Stream::Kind::real);
    }
    if (type != "Integer" && type != "ScaledInteger")
      fail(std::string("field ") + field.name() + " of type " + shown(type) + " is not known");
    const std::int64_t lo = whole(field, "minimum", std::numeric_limits<std::int64_t>::min());
    const std::int64_t hi = whole(field, "maximum", std::numeric_limits<std::int64_t>::max());
    if (hi < lo) fail(std::string("field ") + field.name() + ": its maximum is below its minimum");
    const bool scaled = type == "ScaledInteger";
    return E57Stream::integers(lo, hi, scaled ? attribute(field, "scale", 1) : 1,
                               scaled ? attribute(field, "offset", 0) : 0);
  }

  void read_scan(const pugi::xml_node& scan) {
    ++scan_;
    read_pose(scan);
    const pugi::xml_node points = scan.child("points");
    const std::int64_t records = whole(points, "recordCount", 0);
    if (!points || records <= 0) return;
    // Streams of the fields that matter, and which stream of a packet each is.
    std::vector<std::optional<E57Stream>> streams(kFields);
    std::vector<int> field_of;
    for (const pugi::xml_node field : points.child("prototype").children()) {
      if (field.type() != pugi::node_element) continue;
      const auto* name = std::find_if(std::begin(kFieldNames), std::end(kFieldNames),
                                      [&](const char* n) { return std::string_view(n) == field.name(); });
      const int k = static_cast<int>(name - std::begin(kFieldNames));
      field_of.push_back(k);
      if (k < kFields) streams[static_cast<std::size_t>(k)] = stream_of(field);
    }
    const auto has = [&](int a, int b, int c) {
      return streams[static_cast<std::size_t>(a)] && streams[static_cast<std::size_t>(b)] &&
             streams[static_cast<std::size_t>(c)];
    };
    const bool cartesian = has(kX, kY, kZ);
    if (!cartesian && !has(kRange, kAzimuth, kElevation))
      fail("its points have neither cartesian nor spherical coordinates");
    int bits = 0;
    for (int k = cartesian ? kX : kRange; k <= (cartesian ? kZ : kElevation); ++k)
      bits += streams[static_cast<std::size_t>(k)]->bits();
    if (bits == 0)
      fail("its " + std::to_string(records) + " points all lie in one place; the file is damaged");

    const std::uint64_t section =
        pages_.logical(static_cast<std::uint64_t>(whole(points, "fileOffset", 0)), "points");
    const std::string head = pages_.read(section, 32, "head of the points");
    if (head[0] != 1) fail("no points where the XML says they are");
    const std::uint64_t end =
        section + std::min(FileBytes::load<std::uint64_t>(head.data() + 8), pages_.logical_size() - section);
    std::uint64_t at = pages_.logical(FileBytes::load<std::uint64_t>(head.data() + 16), "packets of points");
    progress_.begin("reading", static_cast<double>(records), "points");
    std::uint64_t done = 0;
    const auto total = static_cast<std::uint64_t>(records);
    while (done < total) {
      if (at + 4 > end)
        fail("it claims " + std::to_string(total) + " points, its data end after " + std::to_string(done));
      const std::string start = pages_.read(at, 6, "packet");
      const std::uint64_t length = FileBytes::load<std::uint16_t>(start.data() + 2) + 1u;
      if (start[0] == 1)
        take_packet(pages_.read(at, length, "packet"), field_of, streams);
      else if (start[0] != 0 && start[0] != 2)
        fail("a packet of unknown type " + std::to_string(start[0]));
      at += length;
      std::uint64_t ready = total - done;
      for (const auto& stream : streams)
        if (stream) ready = std::min(ready, stream->available());
      for (std::uint64_t i = 0; i < ready; ++i) take_point(streams, cartesian);
      for (auto& stream : streams)
        if (stream) stream->compact();
      done += ready;
      progress_.advance(static_cast<double>(ready));
      progress_.check();
    }
  }

  void take_packet(const std::string& packet, const std::vector<int>& field_of,
                   std::vector<std::optional<E57Stream>>& streams) const {
    const std::size_t count = packet.size() < 6 ? 0 : FileBytes::load<std::uint16_t>(packet.data() + 4);
    if (count != field_of.size())
      fail("a packet of " + std::to_string(count) + " fields; its prototype has " +
           std::to_string(field_of.size()));
    std::size_t at = 6 + 2 * count;
    for (std::size_t k = 0; k < count; ++k) {
      if (8 + 2 * k > packet.size()) fail("a packet too short for its fields");
      const std::size_t length = FileBytes::load<std::uint16_t>(packet.data() + 6 + 2 * k);
      if (at > packet.size() || length > packet.size() - at) fail("a packet too short for its fields");
      if (field_of[k] < kFields)
        streams[static_cast<std::size_t>(field_of[k])]->append({packet.data() + at, length});
      at += length;
    }
  }

  void take_point(std::vector<std::optional<E57Stream>>& streams, bool cartesian) {
    double v[kFields] = {};
    for (int k = 0; k < kFields; ++k)
      if (auto& stream = streams[static_cast<std::size_t>(k)]) v[k] = stream->next();
    if (v[cartesian ? kInvalid : kSphericalInvalid] != 0) return;
    const Vec3 p = cartesian ? Vec3(v[kX], v[kY], v[kZ])
                             : Vec3(v[kRange] * std::cos(v[kElevation]) * std::cos(v[kAzimuth]),
                                    v[kRange] * std::cos(v[kElevation]) * std::sin(v[kAzimuth]),
                                    v[kRange] * std::sin(v[kElevation]));
    if (!p.allFinite())
      fail("point " + std::to_string(cloud_.size() + 1) + " has a coordinate that is not a finite number");
    cloud_.points.push_back(turn_ * p + shift_);
    // Attributes are kept where every scan has them.
    if (streams[kIntensity]) {
      ++with_intensity_;
      cloud_.intensity.push_back(static_cast<float>(v[kIntensity]));
    }
    if (streams[kClass]) {
      ++with_class_;
      cloud_.classification.push_back(
          v[kClass] >= 0 && v[kClass] <= 255 ? static_cast<std::uint8_t>(v[kClass]) : std::uint8_t{0});
    }
  }

  const FileBytes& bytes_;
  E57Pages pages_;
  Progress& progress_;
  PointCloud cloud_;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  Vec3 shift_ = Vec3::Zero();
  int scan_ = 0;
  std::size_t with_intensity_ = 0;
  std::size_t with_class_ = 0;
};

}  // namespace

PointCloud read_e57(const FileBytes& bytes, Progress& progress) {
  return Reader(bytes, progress).read();
}

}  // namespace dendrofit
