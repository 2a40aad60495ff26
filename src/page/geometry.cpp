// SPDX-License-Identifier: Apache-2.0
#include "page/geometry.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/vector_math.h"
#include "geometry/bounds.h"
#include "isoatlas/error.h"
#include "isoatlas/mesh.h"
#include "mesh_files/same_mesh.h"

namespace isoatlas::detail::page {
namespace {

using Json = nlohmann::ordered_json;
using Steps = std::array<std::uint32_t, 3>;

constexpr int kMinBits = 20;
constexpr int kMaxBits = 24;  // the significand of a float, the number type of the browser

// Positions are origin + step * integers.
struct Grid3 {
  Vec3 origin;
  double step = 1;
};

Grid3 grid_over(const std::vector<Vec3>& positions, int bits) {
  const Bounds box = bounds_of(positions);
  return {box.low, box.longest() > 0 ? box.longest() / ((1 << bits) - 1) : 1};
}

std::vector<Steps> on_grid(const std::vector<Vec3>& positions, const Grid3& grid) {
  std::vector<Steps> out;
  out.reserve(positions.size());
  const auto steps = [&](double from_origin) {
    return static_cast<std::uint32_t>(std::llround(from_origin / grid.step));
  };
  for (const Vec3& p : positions)
    out.push_back(
        {steps(p.x - grid.origin.x), steps(p.y - grid.origin.y), steps(p.z - grid.origin.z)});
  return out;
}

std::string encoded_vertices(const std::vector<Steps>& vertices) {
  std::string out(meshopt_encodeVertexBufferBound(vertices.size(), sizeof(Steps)), '\0');
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        vertices.data(), vertices.size(), sizeof(Steps)));
  return out;
}

// The positions as decoded in the page: floats, relative to the origin of the grid.
std::vector<Vec3> decoded_vertices(const std::string& code, std::size_t count, const Grid3& grid) {
  std::vector<Steps> steps(count);
  if (meshopt_decodeVertexBuffer(steps.data(), count, sizeof(Steps),
                                 reinterpret_cast<const unsigned char*>(code.data()),
                                 code.size()) != 0)
    throw Error(ErrorCode::internal, "vertices that were encoded for a page cannot be decoded");
  std::vector<Vec3> out;
  out.reserve(count);
  for (const Steps& s : steps)
    out.push_back({static_cast<float>(grid.step * s[0]), static_cast<float>(grid.step * s[1]),
                   static_cast<float>(grid.step * s[2])});
  return out;
}

// The triangles in an order that compresses well.
std::vector<Triangle> reordered(const std::vector<Triangle>& triangles, std::size_t vertex_count) {
  std::vector<Triangle> out(triangles.size());
  meshopt_optimizeVertexCache(out.front().data(), triangles.front().data(), 3 * triangles.size(),
                              vertex_count);
  return out;
}

std::string encoded_triangles(const std::vector<Triangle>& triangles, std::size_t vertex_count) {
  meshopt_encodeIndexVersion(1);
  std::string out(meshopt_encodeIndexBufferBound(3 * triangles.size(), vertex_count), '\0');
  out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                       triangles.front().data(), 3 * triangles.size()));
  return out;
}

std::vector<Triangle> decoded_triangles(const std::string& code, std::size_t count) {
  std::vector<Triangle> out(count);
  if (meshopt_decodeIndexBuffer(out.front().data(), 3 * count, sizeof(std::uint32_t),
                                reinterpret_cast<const unsigned char*>(code.data()),
                                code.size()) != 0)
    throw Error(ErrorCode::internal, "triangles that were encoded for a page cannot be decoded");
  return out;
}

// Sorts triangles for comparison. The encoder may change the order of triangles and their first
// corners, but not their orientation.
std::vector<Triangle> normalised(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles)
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

// Appends `code` to `bytes`. @return its offset and size
Json append(const std::string& code, std::string& bytes) {
  Json out = {{"offset", bytes.size()}, {"bytes", code.size()}};
  bytes += code;
  return out;
}

struct EncodedPositions {
  Grid3 grid;
  std::size_t count = 0;
  std::string code;

  Json append_to(std::string& bytes) const {
    Json out = append(code, bytes);
    out["count"] = count;
    out["origin"] = {grid.origin.x, grid.origin.y, grid.origin.z};
    out["step"] = grid.step;
    return out;
  }
};

// Checks that a level with the decoded positions is the same mesh.
void require_same(const Hierarchy& hierarchy, std::size_t level, const std::vector<Vec3>& decoded,
                  Vec3 origin, const std::vector<Triangle>& triangles,
                  const std::filesystem::path& path) {
  TriangleMesh mesh = hierarchy.mesh(level);
  mesh.triangles = triangles;
  for (Vec3& p : mesh.positions) p = p - origin;
  TriangleMesh read;
  read.positions.assign(decoded.begin(), decoded.begin() + hierarchy.levels[level].vertex_count);
  read.triangles = triangles;
  io::require_same_mesh(mesh, read, false, path, "level " + std::to_string(level));
}

// Encodes positions on the coarsest grid on which all these levels stay the same mesh.
EncodedPositions encoded_positions(const Hierarchy& hierarchy, const std::vector<Vec3>& positions,
                                   const std::vector<std::size_t>& levels,
                                   const std::vector<std::vector<Triangle>>& triangles,
                                   const std::filesystem::path& path) {
  for (int bits = kMinBits;; bits += 2) {
    EncodedPositions out;
    out.grid = grid_over(positions, bits);
    out.count = positions.size();
    out.code = encoded_vertices(on_grid(positions, out.grid));
    const std::vector<Vec3> decoded = decoded_vertices(out.code, out.count, out.grid);
    try {
      for (const std::size_t k : levels)
        require_same(hierarchy, k, decoded, out.grid.origin, triangles[k], path);
      return out;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::bad_file) throw;
      if (bits == kMaxBits)
        throw Error(ErrorCode::bad_file, path.string() +
                                             ": not written: rounding to the finest grid of a "
                                             "page, 2^24 steps, would merge vertices or move them "
                                             "too far");
    }
  }
}

// Distances as shares of the largest one, in 255 steps. They are rounded up, so that the page never
// shows smaller ones.
Json append_distances(const std::vector<float>& distance, std::string& bytes) {
  const float most = std::max(0.0f, *std::max_element(distance.begin(), distance.end()));
  std::string code;
  for (const float d : distance)
    code += static_cast<char>(static_cast<unsigned char>(
        most > 0 ? std::clamp(std::ceil(255.0 * d / most), 0.0, 255.0) : 0));
  Json out = append(code, bytes);
  out["maximum"] = most;
  return out;
}

}  // namespace

Json append_geometry(const Hierarchy& hierarchy, const std::filesystem::path& path,
                     std::string& bytes) {
  const std::size_t level_count = hierarchy.levels.size();
  std::vector<std::vector<Triangle>> triangles;
  std::vector<std::string> codes;
  std::vector<std::size_t> shared;  // levels without positions of their own
  for (std::size_t k = 0; k < level_count; ++k) {
    const Hierarchy::Level& level = hierarchy.levels[k];
    codes.push_back(
        encoded_triangles(reordered(level.triangles, level.vertex_count), level.vertex_count));
    triangles.push_back(decoded_triangles(codes.back(), level.triangles.size()));
    if (normalised(triangles.back()) != normalised(level.triangles))
      throw Error(ErrorCode::internal,
                  "triangles that were encoded for a page differ after decoding");
    if (level.own_positions.empty()) shared.push_back(k);
  }

  Json out;
  std::vector<Vec3> positions = hierarchy.positions;
  // The page computes its extent from these positions, also if all levels have their own.
  if (shared.empty()) positions = hierarchy.levels.back().own_positions;
  out["positions"] =
      encoded_positions(hierarchy, positions, shared, triangles, path).append_to(bytes);
  Json& levels = out["levels"] = Json::array();
  for (std::size_t k = 0; k < level_count; ++k) {
    const Hierarchy::Level& level = hierarchy.levels[k];
    Json entry = {{"vertices", level.vertex_count}};
    entry["triangles"] = append(codes[k], bytes);
    entry["triangles"]["count"] = level.triangles.size();
    if (!level.own_positions.empty())
      entry["own_positions"] =
          encoded_positions(hierarchy, level.own_positions, {k}, triangles, path).append_to(bytes);
    const auto finite = [](float d) { return std::isfinite(d); };
    if (!level.distance.empty() &&
        std::all_of(level.distance.begin(), level.distance.end(), finite))
      entry["distance"] = append_distances(level.distance, bytes);
    levels.push_back(std::move(entry));
  }
  return out;
}

}  // namespace isoatlas::detail::page
