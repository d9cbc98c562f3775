// SPDX-License-Identifier: GPL-3.0-or-later
// Clouds in formats that we read but do not write.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>

namespace dendrofit::test {

inline std::string ascii_ply() {
  return "ply\nformat ascii 1.0\ncomment by hand\nelement camera 1\nproperty list uchar int ids\nelement "
         "vertex 4\n"
         "property double x\nproperty float y\nproperty int z\nproperty uchar red\nproperty float "
         "scalar_Intensity\n"
         "end_header\n2 7 8\n500000.125 1.5 3 255 10\n500001.25 -2.5 4 0 11\n500002.5 0 5 1 12\n500003 1e-3 "
         "6 2 13.5\n";
}

inline std::string big_endian(double value) {
  char bytes[8];
  std::memcpy(bytes, &value, 8);
  std::reverse(bytes, bytes + 8);
  return {bytes, 8};
}

inline std::string big_endian_ply() {
  std::string text =
      "ply\r\nformat binary_big_endian 1.0\r\nelement vertex 3\r\nproperty double x\r\nproperty double y\r\n"
      "property double z\r\nproperty uchar class\r\nend_header\r\n";
  for (const double k : {1.0, 2.0, 3.0})
    text += big_endian(5400000 + k / 8) + big_endian(-k) + big_endian(0.1 * k) + static_cast<char>(k + 1);
  return text;
}

inline std::string ascii_pcd() {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z normal intensity\nSIZE 8 8 8 "
         "4 4\n"
         "TYPE F F F F F\nCOUNT 1 1 1 3 1\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n"
         "1 2 3 0 0 1 9\n500000.5 2 3 0 0 1 8\nnan nan nan 0 0 1 7\n4 5 6.25 0 0 1 6\n";
}

/// LZF of three points, float x y z: literals only, but for the zeros of y as a back reference.
inline std::string packed_pcd() {
  std::string fields;
  for (const float x : {1.0f, 2.0f, 3.0f}) fields.append(reinterpret_cast<const char*>(&x), 4);
  const std::string z = fields;
  std::string packed;
  packed += static_cast<char>(12 - 1 + 1);  // 13 literals: x and the first zero byte of y
  packed += fields + '\0';
  packed += static_cast<char>(7 << 5);  // length 7 + 2 + 2 = 11 from one byte back
  packed += static_cast<char>(2);
  packed += '\0';
  packed += static_cast<char>(12 - 1);
  packed += z;
  std::string text =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA binary_compressed\n";
  for (const std::size_t size : {packed.size(), std::size_t{36}}) {
    const auto size32 = static_cast<std::uint32_t>(size);
    text.append(reinterpret_cast<const char*>(&size32), 4);
  }
  return text + packed;
}

/// Two scans: the first as it is, the second turned a quarter about z and moved.
inline std::string ptx() {
  return "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
         "1 2 3 0.5 10 20 30\n0 0 0 0.5 0 0 0\n2 2 3 0.25 10 20 30\n3 2 3 1 10 20 30\n"
         "1\n2\n10 20 1\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 1 1\n"
         "1 0 0 0.75\n0 2 5 0.125\n";
}

inline std::string pts() {
  return "3\n1.5 2.5 3.5 -120 1 2 3\n2.5 2.5 3.5 130 4 5 6\n3.5 2.5 3.5 7 7 8 9\n";
}

inline std::string decimal_comma_text() {
  return "X;Y;Z;Intensity\r\n500000,25;1,5;2,25;7\r\n500001,25;-1,5;3,25;8\r\n500002,25;0;4,25;9\r\n";
}

}  // namespace dendrofit::test
