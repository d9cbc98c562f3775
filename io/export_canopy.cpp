// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/export_canopy.h"

#include "core/atomic_file.h"
#include "core/errors.h"
#include "core/mesh.h"
#include "io/text_numbers.h"
#include "io/write_mesh.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace dendrofit {
namespace {

constexpr int kDecimals = 6;  // micrometres

/// Cylinders as tubes, shoots, petioles: all that is not a blade. Local coordinates.
TriangleMesh wood_of(const Tree& tree, const Foliage& foliage) {
  TriangleMesh wood = tree_mesh(tree);
  if (!foliage.twigs.empty()) wood.append(tree_mesh(foliage.twigs));
  for (std::size_t i = 0; i < foliage.size(); ++i) foliage.append_petiole(i, wood);
  return wood;
}

TriangleMesh leaves_of(const Foliage& foliage) {
  TriangleMesh leaves;
  leaves.origin_shift = foliage.origin_shift;
  for (std::size_t i = 0; i < foliage.size(); ++i) foliage.append_blade(i, leaves);
  return leaves;
}

void check(const Tree& tree, const Foliage& foliage) {
  tree.validate();
  if (tree.empty()) throw InputError("export: the tree has no cylinder");
  if (!foliage.leaves.empty() && foliage.origin_shift != tree.origin_shift)
    throw InputError("export: tree and leaves have different origin shifts");
}

/// Vertices (each turned by `turned`) and faces of a mesh; `before` vertices stand in the file already.
template <class Turned>
void append_mesh(std::string& text, const TriangleMesh& mesh, std::size_t before, const Turned& turned) {
  text.reserve(text.size() + 40 * mesh.vertices.size() + 24 * mesh.triangles.size());
  for (const Vec3& vertex : mesh.vertices) {
    const Vec3 v = turned(vertex);
    text += 'v';
    for (int k = 0; k < 3; ++k) {
      text += ' ';
      append_fixed(text, v[k], kDecimals);
    }
    text += '\n';
  }
  for (const auto& triangle : mesh.triangles) {
    text += 'f';
    for (const std::uint32_t corner : triangle) {
      text += ' ';
      append_number(text, static_cast<std::int64_t>(before + corner + 1));
    }
    text += '\n';
  }
}

std::string attribute_of(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

}  // namespace

void export_helios(const std::filesystem::path& folder, const Tree& tree, const Foliage& foliage,
                   const std::string& leaf_spectra) {
  check(tree, foliage);
  const auto as_is = [](const Vec3& v) { return v; };
  const TriangleMesh wood = wood_of(tree, foliage);
  std::string obj =
      "# dendrofit, metres, z up, about the origin that scene.xml gives\nmtllib tree.mtl\no wood\nusemtl "
      "wood\n";
  append_mesh(obj, wood, 0, as_is);
  if (foliage.size() > 0) {
    obj += "o leaves\nusemtl leaves\n";
    append_mesh(obj, leaves_of(foliage), wood.vertices.size(), as_is);
  }
  write_file(folder / "tree.obj", obj);
  write_file(folder / "tree.mtl",
             "# Reflectances come from HELIOS++'s spectra at the scanner's wavelength; a line "
             "helios_reflectance (0 to 1)\n"
             "# in a material takes precedence over them. HELIOS++ knows no transmittance.\n"
             "newmtl wood\nKa 0.2 0.2 0.05\nKd 0.2 0.2 0.05\nKs 0 0 0\nhelios_classification "
             "0\nhelios_spectra wood\n\n"
             "newmtl leaves\nKa 0.05 0.4 0.05\nKd 0.05 0.4 0.05\nKs 0 0 0\nhelios_classification "
             "1\nhelios_spectra " +
                 leaf_spectra + "\n");
  std::string offset;
  for (int k = 0; k < 3; ++k) {
    if (k > 0) offset += ';';
    append_number(offset, tree.origin_shift[k]);
  }
  const std::string name =
      attribute_of(std::filesystem::absolute(folder).lexically_normal().filename().string());
  write_file(folder / "scene.xml",
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document>\n  <scene id=\"tree\" name=\"tree\">\n  "
             "  <part id=\"1\">\n"
             "      <filter type=\"objloader\">\n        <param type=\"string\" key=\"filepath\" value=\"" +
                 name +
                 "/tree.obj\" />\n        <param type=\"string\" key=\"up\" value=\"z\" />\n      </filter>\n"
                 "      <filter type=\"translate\">\n        <param type=\"vec3\" key=\"offset\" value=\"" +
                 offset + "\" />\n      </filter>\n    </part>\n  </scene>\n</document>\n");
}

void export_less(const std::filesystem::path& folder, const Tree& tree, const Foliage& foliage) {
  check(tree, foliage);
  const Vec3 foot = tree.start.front();
  const auto y_up = [&](const Vec3& v) -> Vec3 {
    const Vec3 p = v - foot;
    return {p.x(), p.z(), -p.y()};
  };
  // LESS reads an object's line as its name and then groups of four words: component, optical property,
  // temperature, colour.
  std::string objects = "tree tree_wood.obj branch - 0x8b5a2bff";
  std::string obj = "# dendrofit, metres, y up\n";
  append_mesh(obj, wood_of(tree, foliage), 0, y_up);
  write_file(folder / "tree_wood.obj", obj);
  if (foliage.size() > 0) {
    obj = "# dendrofit, metres, y up\n";
    append_mesh(obj, leaves_of(foliage), 0, y_up);
    write_file(folder / "tree_leaves.obj", obj);
    objects += " tree_leaves.obj leaf - 0x006400ff";
  }
  write_file(folder / "objects.txt", objects + "\n");
  write_file(folder / "instances.txt", "tree 50 50 0 0\n");
}

void export_eradiate(const std::filesystem::path& folder, const Tree& tree, const Foliage& foliage) {
  check(tree, foliage);
  const Vec3 foot = tree.start.front();
  std::string text;
  std::vector<Vec3> blade;
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    const Leaf& leaf = foliage.leaves[i];
    const LeafShape& shape = foliage.shapes[leaf.shape];
    blade_vertices(leaf, shape, blade);
    // The blade's middle, its triangles weighted by area.
    Vec3 middle = Vec3::Zero();
    double area = 0;
    for (const auto& t : shape.triangles) {
      const Vec3 &a = blade[t[0]], &b = blade[t[1]], &c = blade[t[2]];
      const Vec3 p = b - a, q = c - a;
      const double twice =
          Vec3(p.y() * q.z() - p.z() * q.y(), p.z() * q.x() - p.x() * q.z(), p.x() * q.y() - p.y() * q.x())
              .norm();
      middle += twice * (a + b + c) / 3;
      area += twice;
    }
    middle = middle / area - foot;
    append_number(text, std::sqrt(foliage.leaf_area(i) / std::numbers::pi));
    for (const double value : {middle.x(), middle.y(), middle.z()}) {
      text += ' ';
      append_fixed(text, value, kDecimals);
    }
    for (int k = 0; k < 3; ++k) {
      text += ' ';
      append_number(text, leaf.normal[k]);
    }
    text += '\n';
  }
  write_file(folder / "leaves.txt", text);
  TriangleMesh wood = wood_of(tree, foliage);
  wood.origin_shift = Vec3::Zero();
  for (Vec3& v : wood.vertices) v -= foot;
  write_mesh(folder / "wood.ply", wood);
}

}  // namespace dendrofit
