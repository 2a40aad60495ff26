// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: reads `v` and `f` lines and skips the others (normals, texture, groups,
// materials).
//
// vtkOBJReader is not used: it stores float positions, and in a file with normals or texture
// coordinates it makes a separate vertex for every corner, so that no two triangles share one.
#include <string>

#include "files/file_error.h"
#include "files/text_scanner.h"
#include "mesh_files/formats.h"
#include "mesh_files/output_buffer.h"
#include "mesh_files/polygons.h"

namespace isoatlas::detail::io {

namespace {

// The next word of a statement, which continues on the next line after a backslash at the end of a
// line; empty at the end of the statement.
std::string_view word_of_statement(TextScanner& scanner) {
  for (;;) {
    std::string_view word = scanner.word();
    if (word.starts_with('#')) {
      return {};
    }
    if (!word.ends_with('\\')) {
      return word;
    }
    word.remove_suffix(1);
    scanner.next_line();
    if (!word.empty()) {
      return word;
    }
  }
}

}  // namespace

TriangleMesh read_obj(const std::filesystem::path& path) {
  const std::string text = file_contents(path);
  TextScanner scanner(text, path);
  TriangleMesh mesh;
  PolygonCutter polygons(mesh);
  std::vector<std::uint32_t> corners;
  // "7", "7/1", "7/1/2" or "7//2": the position is the first number
  const auto corner_of = [&](std::string_view corner) {
    const std::int64_t index =
        scanner.to_integer(corner.substr(0, corner.find('/')), "a vertex number");
    if (index == 0) {
      throw scanner.error("vertex number 0, but vertices are numbered from 1");
    }
    const auto count = static_cast<std::int64_t>(mesh.positions.size());
    return vertex_index(index > 0 ? index - 1
                                  : count + index);  // -1 is the last vertex read so far
  };
  while (scanner.next_line()) {
    const std::string_view keyword = scanner.word();
    if (keyword == "v") {
      const double x =
          scanner.to_number(word_of_statement(scanner), "the x coordinate of a vertex");
      const double y =
          scanner.to_number(word_of_statement(scanner), "the y coordinate of a vertex");
      const double z =
          scanner.to_number(word_of_statement(scanner), "the z coordinate of a vertex");
      mesh.positions.push_back({x, y, z});
    } else if (keyword == "f") {
      corners.clear();
      for (std::string_view corner = word_of_statement(scanner); !corner.empty();
           corner = word_of_statement(scanner)) {
        corners.push_back(corner_of(corner));
      }
      if (corners.size() < 3) {
        throw scanner.error("a face with " + std::to_string(corners.size()) +
                            " corners, expected at least 3");
      }
      polygons.append(corners);
    }
  }
  polygons.cut_concave();
  return mesh;
}

void write_obj(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  OutputBuffer out(file.stream());
  for (const std::string& comment :
       {info.comment, info.space.empty() ? "" : "SPACE=" + info.space}) {
    if (!comment.empty()) {
      out.text("# " + comment + "\n");
    }
  }
  for (const Vec3& p : mesh.positions) {
    out.text("v ");
    out.number(p.x);
    out.text(" ");
    out.number(p.y);
    out.text(" ");
    out.number(p.z);
    out.text("\n");
  }
  for (const Triangle& t : mesh.triangles) {
    out.text("f");
    for (const std::uint32_t corner : t) {
      out.text(" ");
      out.number(std::uint64_t{corner} + 1);
    }
    out.text("\n");
  }
  out.flush();
}

}  // namespace isoatlas::detail::io
