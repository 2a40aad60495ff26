// SPDX-License-Identifier: Apache-2.0
// Neuroglancer's multi-resolution meshes: an octree of fragments per level, compressed by Draco,
// with 16 bits per coordinate.
// @source Neuroglancer, "Precomputed" mesh format (multi-resolution)
#include "isoatlas/neuroglancer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "core/vector_math.h"
#include "files/atomic_file.h"
#include "files/file_error.h"
#include "isoatlas/error.h"
#include "isoatlas/self_intersections.h"
#include "mesh_files/draco_mesh.h"
#include "mesh_files/lattice_mesh.h"
#include "mesh_files/stored_form.h"

namespace isoatlas {
using namespace detail;

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int kBits = 16;
constexpr std::int64_t kSteps = (1 << kBits) - 1;  // along a side of a fragment
// Neuroglancer splits a fragment at this coordinate into those of the next finer level.
constexpr std::int64_t kMiddle = kSteps / 2 + 1;
constexpr std::int64_t kSnap = 3;  // vertices so near a plane are moved onto it
constexpr double kTrianglesPerFragment = 50000;
constexpr int kMaxDepth = 20;  // the finest fragments are 2^-20 of the box
constexpr int kMaxTries = 5;
constexpr const char* kMeshType = "neuroglancer_multilod_draco";
constexpr const char* kSegment = "1";
constexpr const char* kProperties = "segment_properties";

using Cell = std::array<std::uint32_t, 3>;  // place of a fragment among those of its level

// Orders fragments along a Z-curve: x is the lowest of each three bits.
bool is_before(const Cell& a, const Cell& b) {
  // The axis of the highest bit that differs decides; of equal ones the last.
  std::size_t axis = 2;
  for (const std::size_t k : {1u, 0u}) {
    const std::uint32_t here = a[axis] ^ b[axis], other = a[k] ^ b[k];
    if (std::bit_width(other) > std::bit_width(here)) axis = k;
  }
  return a[axis] < b[axis];
}

struct ZOrder {
  bool operator()(const Cell& a, const Cell& b) const { return is_before(a, b); }
};

using Fragments = std::map<Cell, io::IntegerMesh, ZOrder>;

// A cube around all levels, split into 2^depth fragments along each axis at the finest level.
struct Octree {
  Vec3 origin;
  float chunk = 0;  // side of a fragment of the finest level
  int depth = 0;

  double step(std::size_t lod) const {
    return std::ldexp(static_cast<double>(chunk), static_cast<int>(lod)) /
           static_cast<double>(kSteps);
  }
  std::int64_t cells(std::size_t lod) const {
    return std::int64_t{1} << std::max(0, depth - static_cast<int>(lod));
  }
};

Octree octree_around(const Hierarchy& hierarchy, int depth) {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) {
    for (const Vec3& p : hierarchy.view(k).positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  Octree out{low, 0, depth};
  const double side = std::ldexp(largest_coordinate(high - low), -depth);
  out.chunk = static_cast<float>(side);
  while (static_cast<double>(out.chunk) <= side) out.chunk = std::nextafter(out.chunk, INFINITY);
  return out;
}

// The first plane above a coordinate: the faces of fragments and, but at the finest level, their
// middles.
std::int64_t plane_above(std::int64_t x, bool has_middles) {
  const std::int64_t cell = x / kSteps;
  const std::int64_t middle = cell * kSteps + kMiddle;
  return has_middles && middle > x ? middle : (cell + 1) * kSteps;
}

// Moves coordinates that are next to a plane onto it: parts narrower than a few steps could become
// flat, and two flat triangles back to back.
std::int64_t snapped(std::int64_t x, bool has_middles) {
  const std::int64_t plane = plane_above(std::max<std::int64_t>(0, x - kSnap - 1), has_middles);
  return x > kSnap && plane <= x + kSnap ? plane : x;
}

Fragments fragments_of(const io::LatticeMesh& mesh, std::int64_t cells) {
  Fragments out;
  std::map<std::pair<Cell, std::uint32_t>, std::uint32_t> numbers;
  for (const Triangle& t : mesh.triangles) {
    Cell cell;
    for (std::size_t a = 0; a < 3; ++a) {
      std::int64_t low = mesh.positions[t[0]][a];
      for (const std::uint32_t v : t) low = std::min(low, mesh.positions[v][a]);
      cell[a] = static_cast<std::uint32_t>(std::min(low / kSteps, cells - 1));
    }
    io::IntegerMesh& fragment = out[cell];
    Triangle& to = fragment.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, is_new] =
          numbers.try_emplace({cell, t[k]}, static_cast<std::uint32_t>(fragment.positions.size()));
      to[k] = found->second;
      if (!is_new) continue;
      auto& position = fragment.positions.emplace_back();
      for (std::size_t a = 0; a < 3; ++a)
        position[a] = static_cast<std::int32_t>(mesh.positions[t[k]][a] -
                                                static_cast<std::int64_t>(cell[a]) * kSteps);
    }
  }
  return out;
}

// A level as it is stored.
struct StoredLevel {
  std::vector<std::pair<Cell, std::string>> fragments;  // in Z-order; no bytes: no triangles
  TriangleMesh decoded;                                 // in steps, of all fragments together
  double rounding = 0;                                  // largest one of a vertex
};

// Reads the fragments back and joins them at equal positions.
TriangleMesh decoded(const std::vector<std::pair<Cell, std::string>>& fragments) {
  io::LatticeMesh all;
  for (const auto& [cell, bytes] : fragments) {
    if (bytes.empty()) continue;
    const io::IntegerMesh mesh = io::mesh_of_draco(bytes);
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    for (const auto& p : mesh.positions) {
      io::LatticePoint& to = all.positions.emplace_back();
      for (std::size_t a = 0; a < 3; ++a)
        to[a] = p[a] + static_cast<std::int64_t>(cell[a]) * kSteps;
    }
    for (const Triangle& t : mesh.triangles)
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  io::weld(all);
  TriangleMesh out;
  std::vector<std::uint32_t> number(all.positions.size(), kNone);
  for (Triangle& t : all.triangles) {
    for (std::uint32_t& v : t) {
      std::uint32_t& n = number[v];
      if (n == kNone) {
        n = static_cast<std::uint32_t>(out.positions.size());
        const io::LatticePoint& p = all.positions[v];
        out.positions.push_back(
            {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
      }
      v = n;
    }
  }
  out.triangles = std::move(all.triangles);
  return out;
}

StoredLevel stored_level(const MeshView& mesh, const Octree& octree, std::size_t lod) {
  StoredLevel out;
  const double step = octree.step(lod);
  io::LatticeMesh lattice = io::on_lattice(mesh.positions, mesh.triangles, octree.origin, step);
  for (io::LatticePoint& p : lattice.positions) {
    for (std::int64_t& x : p) x = snapped(x, lod > 0);
  }
  const auto is_allowed = [&](std::int64_t from, std::int64_t to) {
    const bool is_on_plane = plane_above(from - 1, lod > 0) == from;
    return to >= 0 && (to == from || (!is_on_plane && snapped(to, lod > 0) == to));
  };
  io::separate(lattice, is_allowed);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const io::LatticePoint& p = lattice.positions[v];
    const Vec3 at{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
    out.rounding = std::max(out.rounding, length(octree.origin + step * at - mesh.positions[v]));
  }
  io::weld(lattice);
  io::cut_at_planes(lattice, [&](std::int64_t x) { return plane_above(x, lod > 0); });
  io::weld(lattice);
  for (const auto& [cell, fragment] : fragments_of(lattice, octree.cells(lod)))
    out.fragments.emplace_back(cell, io::draco_bytes(fragment));
  out.decoded = decoded(out.fragments);
  return out;
}

std::vector<std::pair<std::int64_t, std::int64_t>> kinds_of(const MeshTopology& topology) {
  std::vector<std::pair<std::int64_t, std::int64_t>> out;
  for (const ComponentTopology& c : topology.components)
    out.emplace_back(c.genus(), c.boundary_loops);
  std::sort(out.begin(), out.end());
  return out;
}

bool have_same_topology(const MeshView& mesh, const TriangleMesh& stored) {
  const MeshTopology before = mesh_topology(mesh), after = mesh_topology(stored);
  return after.is_manifold() && after.is_oriented() && kinds_of(before) == kinds_of(after);
}

// Fragments from the finest level to the coarsest. A fragment needs those of coarser levels around
// it; they may be empty.
void add_missing_parents(std::vector<StoredLevel>& lods) {
  for (std::size_t lod = 1; lod < lods.size(); ++lod) {
    std::map<Cell, std::string, ZOrder> all;
    for (auto& [cell, bytes] : lods[lod].fragments) all[cell] = std::move(bytes);
    for (const auto& [cell, bytes] : lods[lod - 1].fragments)
      all.try_emplace({cell[0] / 2, cell[1] / 2, cell[2] / 2});
    lods[lod].fragments.assign(all.begin(), all.end());
  }
}

int first_depth(const Hierarchy& hierarchy) {
  const auto triangles = static_cast<double>(hierarchy.levels.back().triangles.size());
  return std::max(0, static_cast<int>(std::ceil(std::log2(triangles / kTrianglesPerFragment) / 2)));
}

// @param tree  gets the octree with which all levels keep their topology
std::vector<StoredLevel> stored_lods(const Hierarchy& hierarchy, const fs::path& folder,
                                     Octree& tree) {
  const std::size_t count = hierarchy.levels.size();
  const int depth = first_depth(hierarchy);
  for (int more = 0; more < kMaxTries && depth + more <= kMaxDepth; ++more) {
    tree = octree_around(hierarchy, depth + more);
    std::vector<StoredLevel> lods;
    for (std::size_t lod = 0; lod < count; ++lod) {
      const MeshView mesh = hierarchy.view(count - 1 - lod);
      lods.push_back(stored_level(mesh, tree, lod));
      if (!have_same_topology(mesh, lods.back().decoded)) break;
      if (lod + 1 < count) continue;
      add_missing_parents(lods);
      return lods;
    }
  }
  throw io::bad_file(folder, "not written: 16 bits per coordinate would change the topology");
}

// Bytes of a file, little endian.
class Bytes {
 public:
  void add(std::uint32_t value) {
    for (int bit = 0; bit < 32; bit += 8)
      text_ += static_cast<char>(static_cast<unsigned char>(value >> bit));
  }
  void add(float value) { add(std::bit_cast<std::uint32_t>(value)); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

double mean_edge(const MeshView& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k)
      sum += length(mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]]);
  }
  return sum / (3 * static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size())));
}

std::string manifest_of(const Hierarchy& hierarchy, const Octree& tree,
                        const std::vector<StoredLevel>& lods) {
  Bytes out;
  for (int a = 0; a < 3; ++a) out.add(tree.chunk);
  for (int a = 0; a < 3; ++a) out.add(0.0f);  // the origin is in the transform
  out.add(static_cast<std::uint32_t>(lods.size()));
  double scale = 0;
  for (std::size_t lod = 0; lod < lods.size(); ++lod) {
    scale = std::max(mean_edge(hierarchy.view(lods.size() - 1 - lod)), 1.01 * scale);
    out.add(static_cast<float>(scale));
  }
  for (std::size_t i = 0; i < 3 * lods.size(); ++i) out.add(0.0f);
  for (const StoredLevel& lod : lods) out.add(static_cast<std::uint32_t>(lod.fragments.size()));
  for (const StoredLevel& lod : lods) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (const auto& [cell, bytes] : lod.fragments) out.add(cell[a]);
    }
    for (const auto& [cell, bytes] : lod.fragments)
      out.add(static_cast<std::uint32_t>(bytes.size()));
  }
  return out.text();
}

// Neuroglancer's unit is the nanometre.
std::string info_of(const Octree& tree, LengthUnit unit) {
  const double scale = io::convert_length(1, unit, LengthUnit::nanometre);
  const Vec3 at = scale * tree.origin;
  const Json info = {{"@type", kMeshType},
                     {"vertex_quantization_bits", kBits},
                     {"transform", {scale, 0, 0, at.x, 0, scale, 0, at.y, 0, 0, scale, at.z}},
                     {"lod_scale_multiplier", 1},
                     {"segment_properties", kProperties}};
  return info.dump(2) + "\n";
}

std::string properties_of(const std::string& label) {
  const Json property = {{"id", "label"}, {"type", "label"}, {"values", {label}}};
  const Json info = {{"@type", "neuroglancer_segment_properties"},
                     {"inline", {{"ids", {kSegment}}, {"properties", Json::array({property})}}}};
  return info.dump(2) + "\n";
}

void write_file(const fs::path& path, const std::string& bytes) {
  io::AtomicFile file(path);
  file.stream() << bytes;
  file.commit();
}

// Refuses to overwrite the description of something else, for example of an image.
void require_own_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / "info", error)) return;
  std::ifstream in(folder / "info");
  const Json info = Json::parse(in, nullptr, false);
  if (!info.is_object() || info.value("@type", "") != kMeshType)
    throw io::bad_file(folder,
                       "cannot be written: its file info describes something else; expected "
                       "a new folder, or one with a mesh for Neuroglancer");
}

}  // namespace

void check_neuroglancer_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw io::bad_file(folder, "cannot be written: it is a file, expected a folder");
  require_own_folder(folder);
}

NeuroglancerMesh write_neuroglancer(const Hierarchy& hierarchy, const fs::path& folder,
                                    const HierarchyFileInfo& info, const RunControl& control) {
  return io::translate_exceptions(folder, [&] {
    check_neuroglancer_folder(folder);
    if (hierarchy.levels.empty() || hierarchy.levels.back().triangles.empty())
      throw Error(ErrorCode::bad_argument,
                  folder.string() + ": not written: there are no triangles");
    Octree tree;
    const std::vector<StoredLevel> lods = stored_lods(hierarchy, folder, tree);
    NeuroglancerMesh out;
    std::string data;
    for (const StoredLevel& lod : lods) {
      for (const auto& [cell, bytes] : lod.fragments) data += bytes;
      out.fragments += lod.fragments.size();
    }
    for (std::size_t k = lods.size(); k-- > 0;) {
      out.rounding.push_back(lods[k].rounding);
      const TriangleMesh& mesh = lods[k].decoded;
      out.self_intersections.push_back(
          self_intersections(mesh.positions, mesh.triangles, {}, control).size());
    }
    const std::string manifest = manifest_of(hierarchy, tree, lods);
    out.bytes = data.size() + manifest.size();
    std::error_code error;
    fs::create_directories(folder / kProperties, error);
    if (error) throw io::bad_file(folder, "cannot be written: " + error.message());
    write_file(folder / kSegment, data);
    write_file(folder / (std::string(kSegment) + ".index"), manifest);
    write_file(folder / kProperties / "info",
               properties_of(info.mesh.comment.empty() ? "isosurface" : info.mesh.comment));
    write_file(folder / "info", info_of(tree, info.mesh.unit));
    return out;
  });
}

}  // namespace isoatlas
