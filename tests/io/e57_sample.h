// SPDX-License-Identifier: GPL-3.0-or-later
// Makes small E57 files by the book (ASTM E2807), with known points.
#pragma once

#include "core/types.h"
#include "io/e57_pages.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace dendrofit::test {

class E57Sample {
 public:
  /// A field's stream: its prototype element, and its numbers packed into bits.
  struct Stream {
    std::string element;
    std::string packed;
  };

  static Stream reals(const std::string& name, const std::vector<double>& values, bool single) {
    Stream s{"<" + name + " type=\"Float\"" + (single ? " precision=\"single\"" : "") + "/>", ""};
    for (const double v : values) {
      const auto f = static_cast<float>(v);
      s.packed.append(single ? reinterpret_cast<const char*>(&f) : reinterpret_cast<const char*>(&v),
                      single ? 4 : 8);
    }
    return s;
  }

  static Stream integers(const std::string& name, const std::vector<std::int64_t>& values, std::int64_t lo,
                         std::int64_t hi, const std::string& scaling = "") {
    Stream s{"<" + name + " type=\"" + (scaling.empty() ? "Integer" : "ScaledInteger") + "\" minimum=\"" +
                 std::to_string(lo) + "\" maximum=\"" + std::to_string(hi) + "\" " + scaling + "/>",
             ""};
    int bits = 0;
    while ((static_cast<std::uint64_t>(hi - lo) >> bits) != 0) ++bits;
    std::size_t at = 0;
    for (const std::int64_t v : values) {
      for (int b = 0; b < bits; ++b, ++at) {
        if (at % 8 == 0) s.packed += '\0';
        if ((static_cast<std::uint64_t>(v - lo) >> b) & 1)
          s.packed.back() = static_cast<char>(s.packed.back() | (1 << (at % 8)));
      }
    }
    return s;
  }

  /// Adds a scan whose streams are cut into packets of at most `cut` bytes each, an index packet and an empty
  /// one between.
  void add_scan(std::uint64_t records, const std::vector<Stream>& streams, const std::string& pose,
                std::size_t cut) {
    while (logical_.size() % 4) logical_ += '\0';
    const std::uint64_t section = logical_.size();
    std::string packets;
    std::size_t longest = 0;
    for (const Stream& s : streams) longest = std::max(longest, s.packed.size());
    for (std::size_t from = 0; from < longest; from += cut) {
      std::string lengths;
      std::string content;
      for (const Stream& s : streams) {
        const std::string part = from < s.packed.size() ? s.packed.substr(from, cut) : std::string();
        append(lengths, static_cast<std::uint16_t>(part.size()));
        content += part;
      }
      std::string body = lengths + content;
      while ((body.size() + 6) % 4) body += '\0';
      packets += std::string("\1\0", 2);
      append(packets, static_cast<std::uint16_t>(body.size() + 6 - 1));
      append(packets, static_cast<std::uint16_t>(streams.size()));
      packets += body;
      packets += std::string("\2\0\7\0\0\0\0\0", 8);  // an empty packet of 8 bytes
    }
    logical_ += std::string("\1\0\0\0\0\0\0\0", 8);
    append(logical_, std::uint64_t{32 + packets.size()});
    append(logical_, physical(section + 32));
    append(logical_, std::uint64_t{0});
    logical_ += packets;
    std::string prototype;
    for (const Stream& s : streams) prototype += s.element;
    scans_ += "<vectorChild type=\"Structure\"><guid type=\"String\">{" + std::to_string(section) +
              "}</guid>" + pose + "<points type=\"CompressedVector\" fileOffset=\"" +
              std::to_string(physical(section)) + "\" recordCount=\"" + std::to_string(records) +
              "\"><prototype type=\"Structure\">" + prototype +
              "</prototype><codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"/></points></vectorChild>";
  }

  static std::string pose(double w, double x, double y, double z, const Vec3& t) {
    const auto one = [](const std::string& name, double v) {
      return "<" + name + " type=\"Float\">" + std::to_string(v) + "</" + name + ">";
    };
    return "<pose type=\"Structure\"><rotation type=\"Structure\">" + one("w", w) + one("x", x) +
           one("y", y) + one("z", z) + "</rotation><translation type=\"Structure\">" + one("x", t.x()) +
           one("y", t.y()) + one("z", t.z()) + "</translation></pose>";
  }

  std::string file() const {
    const std::string xml =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
        "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\">"
        "<formatName type=\"String\"><![CDATA[ASTM E57 3D Imaging Data File]]></formatName><guid "
        "type=\"String\">{1}</guid>"
        "<versionMajor type=\"Integer\">1</versionMajor><versionMinor type=\"Integer\">0</versionMinor>"
        "<coordinateMetadata type=\"String\"><![CDATA[LOCAL_CS[\"yard\"]]]></coordinateMetadata>"
        "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">" +
        scans_ + "</data3D><images2D type=\"Vector\" allowHeterogeneousChildren=\"1\"/></e57Root>\n";
    std::string logical = logical_;
    while (logical.size() % 4) logical += '\0';
    const std::uint64_t xml_at = physical(logical.size());
    logical += xml;
    while (logical.size() % 1020) logical += '\0';
    std::string head = "ASTM-E57";
    append(head, std::uint32_t{1});
    append(head, std::uint32_t{0});
    append(head, std::uint64_t{logical.size() / 1020 * 1024});
    append(head, xml_at);
    append(head, std::uint64_t{xml.size()});
    append(head, std::uint64_t{1024});
    logical.replace(0, 48, head);
    std::string file;
    for (std::size_t at = 0; at < logical.size(); at += 1020) {
      const std::string page = logical.substr(at, 1020);
      const std::uint32_t crc = crc32c(page.data(), page.size());
      file += page;
      for (int k = 3; k >= 0; --k) file += static_cast<char>(crc >> (8 * k));
    }
    return file;
  }

 private:
  template <class Number>
  static void append(std::string& to, Number value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  static std::uint64_t physical(std::uint64_t logical) { return logical / 1020 * 1024 + logical % 1020; }

  std::string logical_ = std::string(48, '\0');
  std::string scans_;
};

/// Three scans: doubles; scaled integers of 11, 21 and 33 bits with an invalid point; spherical singles,
/// turned.
inline std::string e57_file() {
  E57Sample sample;
  std::vector<double> x, y, z, i;
  std::vector<std::int64_t> a, b, c, invalid;
  for (int k = 0; k < 40; ++k) {
    x.push_back(100.125 + k);
    y.push_back(-0.5 * k);
    z.push_back(0.1 * k);
    i.push_back(0.01 * k);
    a.push_back(k - 1000);
    b.push_back(50000 * static_cast<std::int64_t>(k));
    c.push_back(100000000LL * k - 3);
    invalid.push_back(k == 7 ? 2 : 0);
  }
  sample.add_scan(40,
                  {E57Sample::reals("cartesianX", x, false), E57Sample::reals("cartesianY", y, false),
                   E57Sample::reals("cartesianZ", z, false), E57Sample::reals("intensity", i, true)},
                  "", 100);
  sample.add_scan(40,
                  {E57Sample::integers("cartesianInvalidState", invalid, 0, 2),
                   E57Sample::integers("cartesianX", a, -1000, 1000, "scale=\"0.001\" offset=\"5\""),
                   E57Sample::integers("rowIndex", a, -1000, 1000),
                   E57Sample::integers("cartesianY", b, 0, 2000000, "scale=\"0.0001\""),
                   E57Sample::integers("intensity", b, 0, 2000000),
                   E57Sample::integers("cartesianZ", c, -3, 5000000000LL, "scale=\"1e-8\"")},
                  E57Sample::pose(1, 0, 0, 0, {10, 20, 30}), 13);
  sample.add_scan(2,
                  {E57Sample::reals("sphericalRange", {2, 4}, true),
                   E57Sample::reals("sphericalAzimuth", {0, std::acos(-1.0) / 2}, true),
                   E57Sample::reals("sphericalElevation", {0, std::acos(-1.0) / 6}, false),
                   E57Sample::reals("intensity", {1, 2}, true)},
                  E57Sample::pose(0.7071068, 0, 0, 0.7071068, {0, 0, 1}), 1000);  // a quarter turn about z
  return sample.file();
}

}  // namespace dendrofit::test
