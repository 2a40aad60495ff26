// SPDX-License-Identifier: Apache-2.0
// STL: triangles as three float positions, without indices. Readers find the shared vertices by
// equal positions.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "core/file_name.h"
#include "files/file_error.h"
#include "files/text_scanner.h"
#include "mesh_files/formats.h"
#include "mesh_files/output_buffer.h"
#include "mesh_files/position_table.h"
#include "mesh_files/same_mesh.h"

namespace isoatlas::detail::io {

namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;  // normal, three corners, 2 unused bytes

Float3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z};
  const Vec3 v{c.x - a.x, c.y - a.y, c.z - a.z};
  const Vec3 n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  const double length = std::hypot(n.x, n.y, n.z);
  if (!std::isfinite(length) || length == 0) {
    return {0, 0, 0};  // readers then compute the normal from the corners
  }
  return {static_cast<float>(n.x / length), static_cast<float>(n.y / length),
          static_cast<float>(n.z / length)};
}

TriangleMesh read_binary(const std::string& contents, std::uint32_t triangle_count) {
  TriangleMesh mesh;
  mesh.triangles.reserve(triangle_count);
  PositionTable<float> table(std::size_t{3} * triangle_count);
  for (std::size_t t = 0; t < triangle_count; ++t) {
    std::array<Float3, 3> corners;
    std::memcpy(corners.data(),
                contents.data() + kHeaderBytes + 4 + t * kTriangleBytes + sizeof(Float3),
                sizeof corners);
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = table.number_of(corners[k]);
    }
    mesh.triangles.push_back(triangle);
  }
  mesh.positions = table.positions();
  return mesh;
}

TriangleMesh read_ascii(const std::string& contents, const std::filesystem::path& path) {
  TextScanner scanner(contents, path);
  TriangleMesh mesh;
  PositionTable<double> table(contents.size() /
                              12);  // length of the shortest line of a corner, "vertex 0 0 0"
  std::vector<std::uint32_t> corners;
  bool is_inside_solid = false;
  bool is_inside_loop = false;
  while (scanner.next_line()) {
    const std::string keyword = lower_case(scanner.word());
    if (keyword == "solid") {
      is_inside_solid = true;
    } else if (keyword == "endsolid") {
      is_inside_solid = false;
    } else if (keyword == "outer") {
      corners.clear();
      is_inside_loop = true;
    } else if (keyword == "vertex") {
      if (!is_inside_loop) {
        throw scanner.error("a vertex outside of a loop");
      }
      const double x = scanner.number("the x coordinate of a vertex");
      const double y = scanner.number("the y coordinate of a vertex");
      const double z = scanner.number("the z coordinate of a vertex");
      if (std::isnan(x) || std::isnan(y) || std::isnan(z)) {
        throw scanner.error("the position of a vertex is not finite");
      }
      corners.push_back(table.number_of({x, y, z}));
    } else if (keyword == "endloop") {
      if (corners.size() != 3) {
        throw scanner.error("a facet with " + std::to_string(corners.size()) +
                            " corners, expected 3");
      }
      mesh.triangles.push_back({corners[0], corners[1], corners[2]});
      is_inside_loop = false;
    } else if (!keyword.empty() && keyword != "facet" && keyword != "endfacet") {
      throw scanner.error("found '" + one_line(keyword, 40) +
                          "', expected a line of an ascii STL file");
    }
  }
  if (is_inside_solid || is_inside_loop) {
    throw scanner.error("the file ends here, expected endsolid");
  }
  mesh.positions = table.positions();
  return mesh;
}

}  // namespace

TriangleMesh read_stl(const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little, "binary STL is little endian");
  const std::string contents = file_contents(path);
  // Some binary files begin with "solid" too: the file size shows which kind it is.
  std::uint32_t triangle_count = 0;
  if (contents.size() >= kHeaderBytes + sizeof triangle_count) {
    std::memcpy(&triangle_count, contents.data() + kHeaderBytes, sizeof triangle_count);
  }
  const std::uint64_t binary_bytes =
      kHeaderBytes + sizeof triangle_count + std::uint64_t{triangle_count} * kTriangleBytes;
  if (contents.size() == binary_bytes) {
    return read_binary(contents, triangle_count);
  }
  const std::size_t first = contents.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  const bool is_text =
      contents.find('\0') == std::string::npos;  // in binary, every triangle ends in two zero bytes
  if (is_text && first != std::string::npos && lower_case(contents.substr(first, 5)) == "solid") {
    return read_ascii(contents, path);
  }
  if (contents.size() < kHeaderBytes + sizeof triangle_count) {
    throw bad_file(path, "is too short for an STL file");
  }
  throw bad_file(path, "states " + std::to_string(triangle_count) + " triangles, which are " +
                           std::to_string(binary_bytes) + " bytes, but has " +
                           std::to_string(contents.size()));
}

void write_stl(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  if (mesh.triangles.size() > 0xFFFF'FFFFU) {
    throw bad_file(file.destination(),
                   "not written: it has more triangles than an STL file can count (4294967295)");
  }
  OutputBuffer out(file.stream());
  // Does not begin with "solid", which marks an ascii file. The space precedes the comment, which
  // may be cut.
  std::string header = info.space.empty() ? "STL" : "SPACE=" + info.space;
  if (info.unit != LengthUnit::unknown) header += " UNIT=" + std::string(symbol(info.unit));
  header += info.comment.empty() ? "" : " " + info.comment;
  header.resize(kHeaderBytes, '\0');
  out.text(header);
  out.bytes(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    out.bytes(normal_of(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
    for (const std::uint32_t v : t) {
      out.bytes(rounded(mesh.positions[v], v, file.destination()));
    }
    out.bytes(std::uint16_t{0});
  }
  out.flush();
}

}  // namespace isoatlas::detail::io
