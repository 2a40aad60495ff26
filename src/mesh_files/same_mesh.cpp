// SPDX-License-Identifier: Apache-2.0
#include "mesh_files/same_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/float32.h"
#include "core/vector_math.h"
#include "files/file_error.h"
#include "mesh_files/position_table.h"

namespace isoatlas::detail::io {

namespace {

constexpr std::uint32_t kUnknown = 0xFFFF'FFFFU;
constexpr const char* kAdvice =
    "; write .ply, .obj, .off, .vtp, .3mf or .vtm instead, which keep double precision";

// Vertices with different positions can still become collinear, so the rounding must be small
// compared with the edges.
constexpr double kMostRoundingPerEdge = 0.1;

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      sum += length(mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]]);
    }
  }
  return sum / static_cast<double>(3 * mesh.triangles.size());
}

class Comparison {
 public:
  Comparison(const std::filesystem::path& path, std::string_view what)
      : path_(path), where_(what.empty() ? "" : " of " + std::string(what)) {}

  /// For each vertex of `written` its number in `read`; kUnknown for vertices that are in no
  /// triangle.
  std::vector<std::uint32_t> counterparts(const TriangleMesh& written,
                                          const TriangleMesh& read) const {
    require(written.triangles.size() == read.triangles.size(),
            "the number of triangles" + where_ + " differs");
    std::vector<std::uint32_t> to_read(written.positions.size(), kUnknown);
    std::vector<std::uint32_t> to_written(read.positions.size(), kUnknown);
    for (std::size_t t = 0; t < written.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t w = written.triangles[t][k];
        const std::uint32_t r = read.triangles[t][k];
        require(r < read.positions.size(),
                "triangle " + std::to_string(t) + where_ + " has a corner out of range");
        if (to_written[r] != kUnknown && to_written[r] != w) {
          throw merged(to_written[r], w);
        }
        require(to_read[w] == kUnknown || to_read[w] == r,
                "vertex " + std::to_string(w) + where_ + " became several vertices");
        to_read[w] = r;
        to_written[r] = w;
      }
    }
    return to_read;
  }

  /// In formats with indices, two vertices may have had one position before, but rounding must not
  /// have merged them.
  void require_none_merged(const TriangleMesh& written, const TriangleMesh& read) const {
    PositionTable<double> table(read.positions.size());
    std::vector<std::uint32_t> first;  // first vertex at each position
    for (std::uint32_t v = 0; v < read.positions.size(); ++v) {
      const Vec3& p = read.positions[v];
      const std::uint32_t number = table.number_of({p.x, p.y, p.z});
      if (number == first.size()) {
        first.push_back(v);
      } else if (written.positions[first[number]] != written.positions[v]) {
        throw merged(first[number], v);
      }
    }
  }

  void require_same_topology(const TriangleMesh& written, const TriangleMesh& read) const {
    MeshTopology a = mesh_topology(written);
    MeshTopology b = mesh_topology(read);
    std::ranges::sort(a.components);  // their order depends on the numbers of the vertices
    std::ranges::sort(b.components);
    require(a.edges == b.edges && a.degenerate_triangles == b.degenerate_triangles &&
                a.non_manifold_edges == b.non_manifold_edges &&
                a.non_manifold_vertices == b.non_manifold_vertices &&
                a.inconsistent_edges == b.inconsistent_edges &&
                a.boundary_edges == b.boundary_edges && a.components == b.components,
            "the topology" + where_ + " differs");
  }

  void require(bool same, const std::string& difference) const {
    if (!same) {
      throw Error(ErrorCode::internal,
                  one_line(path_.string() + ": not written: read back, " + difference));
    }
  }

  const std::string& where() const { return where_; }

 private:
  Error merged(std::uint32_t a, std::uint32_t b) const {
    return bad_file(path_, "not written: vertices " + std::to_string(a) + " and " +
                               std::to_string(b) + where_ +
                               " would become one in its float coordinates" + kAdvice);
  }

  const std::filesystem::path& path_;
  std::string where_;
};

}  // namespace

Float3 rounded(const Vec3& position, std::size_t vertex, const std::filesystem::path& path) {
  const Float3 p{static_cast<float>(position.x), static_cast<float>(position.y),
                 static_cast<float>(position.z)};
  if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
    throw bad_file(path, "not written: vertex " + std::to_string(vertex) +
                             " is out of the range of its float coordinates" + kAdvice);
  }
  return p;
}

std::vector<Vec3> all_rounded(const std::vector<Vec3>& positions, const Vec3& translation,
                              const std::filesystem::path& path) {
  std::vector<Vec3> result;
  result.reserve(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3 p = positions[v] - translation;
    rounded(p, v, path);  // throws where it is out of range
    result.push_back({to_float32(p.x), to_float32(p.y), to_float32(p.z)});
  }
  return result;
}

double largest_rounding(const std::vector<Vec3>& positions, const Vec3& translation,
                        const std::filesystem::path& path) {
  const std::vector<Vec3> stored = all_rounded(positions, translation, path);
  double largest = 0;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    const Vec3& q = stored[v];
    largest = std::max(largest, std::hypot(p.x - (q.x + translation.x), p.y - (q.y + translation.y),
                                           p.z - (q.z + translation.z)));
  }
  return largest;
}

void require_rounding_within(double expected, double found, const std::filesystem::path& path) {
  if (!(found <= expected)) {
    throw Error(ErrorCode::internal,
                one_line(path.string() + ": not written: read back, positions are rounded by " +
                         number(found) + ", expected at most " + number(expected)));
  }
}

double require_same_mesh(const TriangleMesh& written, const TriangleMesh& read, bool renumbered,
                         const std::filesystem::path& path, std::string_view what) {
  const Comparison comparison(path, what);
  std::vector<std::uint32_t> counterpart;
  if (renumbered) {
    counterpart = comparison.counterparts(written, read);
  } else {
    comparison.require(written.positions.size() == read.positions.size(),
                       "the number of vertices" + comparison.where() + " differs");
    comparison.require(written.triangles == read.triangles,
                       "the triangles" + comparison.where() + " differ");
    comparison.require_none_merged(written, read);
  }
  comparison.require_same_topology(written, read);

  double largest = 0;
  for (std::size_t v = 0; v < written.positions.size(); ++v) {
    const std::size_t r = renumbered ? counterpart[v] : v;
    if (r == kUnknown) {
      continue;
    }
    const Vec3& a = written.positions[v];
    const Vec3& b = read.positions[r];
    largest = std::max(largest, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
  }
  if (const double edge = mean_edge(written); largest > kMostRoundingPerEdge * edge) {
    throw bad_file(path, "not written: its float coordinates would move vertices by up to " +
                             number(largest) + ", but edges" + comparison.where() + " are " +
                             number(edge) + " long on average" + kAdvice);
  }
  return largest;
}

}  // namespace isoatlas::detail::io
