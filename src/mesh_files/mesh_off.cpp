// SPDX-License-Identifier: Apache-2.0
// Object File Format, ascii: "OFF", then the numbers of vertices, faces and edges, then one line
// for each vertex and face. Variants with colours or normals (COFF, NOFF, ...) also begin each line
// with the position; the rest of the line is skipped.
#include <algorithm>
#include <array>
#include <string>

#include "files/file_error.h"
#include "files/text_scanner.h"
#include "mesh_files/formats.h"
#include "mesh_files/output_buffer.h"
#include "mesh_files/polygons.h"

namespace isoatlas::detail::io {

namespace {

// The first word of the next line that is neither empty nor a comment.
std::string_view first_word_of_next_line(TextScanner& scanner) {
  while (scanner.next_line()) {
    if (const std::string_view word = scanner.word(); !word.empty() && !word.starts_with('#')) {
      return word;
    }
  }
  throw scanner.error("the file ends here, expected more lines");
}

}  // namespace

TriangleMesh read_off(const std::filesystem::path& path) {
  const std::string text = file_contents(path);
  TextScanner scanner(text, path);
  const std::string_view keyword = first_word_of_next_line(scanner);
  constexpr std::array<std::string_view, 11> kKnown{"OFF",   "COFF",   "NOFF",   "STOFF",
                                                    "CNOFF", "STCOFF", "STNOFF", "STCNOFF",
                                                    "NCOFF", "NSTOFF", "NCSTOFF"};
  if (std::ranges::find(kKnown, keyword) == kKnown.end()) {
    throw scanner.error("found '" + one_line(keyword, 40) + "', expected OFF");
  }
  std::string_view word = scanner.word();
  if (word == "BINARY") {
    throw unsupported(path, "is a binary OFF file, expected an ascii one");
  }
  if (word.empty() || word.starts_with('#')) {
    word = first_word_of_next_line(scanner);
  }
  const std::int64_t vertices = scanner.to_integer(word, "the number of vertices");
  const std::int64_t faces = scanner.integer("the number of faces");
  // The shortest lines are "0 0 0\n" for a vertex and "0\n" for a face.
  const auto remaining = static_cast<std::int64_t>(scanner.remaining()) + 1;
  if (vertices < 0 || faces < 0 || vertices > remaining / 6 || faces > remaining / 2) {
    throw scanner.error("states " + std::to_string(vertices) + " vertices and " +
                        std::to_string(faces) + " faces, the file is too short for them");
  }

  TriangleMesh mesh;
  PolygonCutter polygons(mesh);
  mesh.positions.reserve(static_cast<std::size_t>(vertices));
  mesh.triangles.reserve(static_cast<std::size_t>(faces));
  for (std::int64_t v = 0; v < vertices; ++v) {
    const double x =
        scanner.to_number(first_word_of_next_line(scanner), "the x coordinate of a vertex");
    const double y = scanner.number("the y coordinate of a vertex");
    const double z = scanner.number("the z coordinate of a vertex");
    mesh.positions.push_back({x, y, z});
  }
  std::vector<std::uint32_t> corners;
  for (std::int64_t f = 0; f < faces; ++f) {
    const std::int64_t count =
        scanner.to_integer(first_word_of_next_line(scanner), "the number of corners of a face");
    if (count < 0) {
      throw scanner.error("a face with " + std::to_string(count) + " corners");
    }
    corners.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      corners.push_back(vertex_index(scanner.integer("a vertex number")));
    }
    polygons.append(corners);
  }
  polygons.cut_concave();
  return mesh;
}

void write_off(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  OutputBuffer out(file.stream());
  out.text("OFF\n");
  for (const std::string& comment :
       {info.comment, info.space.empty() ? "" : "SPACE=" + info.space}) {
    if (!comment.empty()) {
      out.text("# " + comment + "\n");
    }
  }
  out.number(mesh.positions.size());
  out.text(" ");
  out.number(mesh.triangles.size());
  out.text(" 0\n");  // the number of edges is never used
  for (const Vec3& p : mesh.positions) {
    out.number(p.x);
    out.text(" ");
    out.number(p.y);
    out.text(" ");
    out.number(p.z);
    out.text("\n");
  }
  for (const Triangle& t : mesh.triangles) {
    out.text("3");
    for (const std::uint32_t corner : t) {
      out.text(" ");
      out.number(corner);
    }
    out.text("\n");
  }
  out.flush();
}

}  // namespace isoatlas::detail::io
