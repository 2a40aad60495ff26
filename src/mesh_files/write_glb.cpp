// SPDX-License-Identifier: Apache-2.0
// Binary glTF 2.0. Levels are levels of detail (extension MSFT_lod); closed levels have the
// extension EXT_mesh_manifold. docs/reference/files.md draws the layout.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/vector_math.h"
#include "files/file_error.h"
#include "geometry/bounds.h"
#include "geometry/float32_origin.h"
#include "geometry/vertex_normals.h"
#include "mesh_files/formats.h"
#include "mesh_files/output_buffer.h"
#include "mesh_files/same_mesh.h"
#include "mesh_files/stored_form.h"

namespace isoatlas::detail::io {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

std::vector<Float3> stored_normals(const TriangleMesh& mesh, const Bounds& box) {
  std::vector<Float3> normals;
  normals.reserve(mesh.positions.size());
  for (const Vec3& normal :
       vertex_normals(mesh, std::max(box.longest(), std::numeric_limits<double>::min()))) {
    // glTF requires unit vectors; if the face normals cancel out, any direction will do.
    normals.push_back(normal == Vec3{}
                          ? Float3{0, 0, 1}
                          : Float3{static_cast<float>(normal.x), static_cast<float>(normal.y),
                                   static_cast<float>(normal.z)});
  }
  return normals;
}

// The binary chunk, which grows, and the JSON that describes its parts.
class Buffer {
 public:
  /// @return the index of the new view
  template <class Value>
  std::size_t add_view(const std::vector<Value>& values, int target) {
    Json view = {{"buffer", 0},
                 {"byteOffset", bytes_.size()},
                 {"byteLength", values.size() * sizeof(Value)}};
    if (target == kArrayBuffer) {
      view["byteStride"] = sizeof(Value);
    }
    view["target"] = target;
    views_.push_back(std::move(view));
    const auto* first = reinterpret_cast<const char*>(values.data());
    bytes_.append(
        first, values.size() * sizeof(Value));  // always a multiple of 4: all values have 4 bytes
    return views_.size() - 1;
  }

  /// @return the index of the new accessor
  std::size_t add_accessor(Json accessor) {
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  std::string& bytes() { return bytes_; }
  Json& views() { return views_; }
  Json& accessors() { return accessors_; }

 private:
  std::string bytes_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

Json vec3_accessor(std::size_t view, std::size_t count) {
  return {{"bufferView", view}, {"componentType", kFloat}, {"count", count}, {"type", "VEC3"}};
}

// glTF requires the exact range of the stored floats.
void add_range(Json& accessor, const std::vector<Float3>& positions, std::size_t count) {
  Float3 low = positions[0];
  Float3 high = low;
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], positions[v][k]);
      high[k] = std::max(high[k], positions[v][k]);
    }
  }
  accessor["min"] = low;
  accessor["max"] = high;
}

std::vector<Float3> all_floats(const std::vector<Vec3>& positions, Vec3 translation,
                               const std::filesystem::path& path) {
  std::vector<Float3> result;
  result.reserve(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    result.push_back(rounded(positions[v] - translation, v, path));
  }
  return result;
}

// The smallest share of the screen for which a level is used: there, the next coarser level has as
// many triangles per pixel as the finest has on a full screen. The coarsest level is never hidden.
Json screen_coverage(const std::vector<Hierarchy::Level>& levels) {
  const auto finest = static_cast<double>(std::max<std::size_t>(levels.back().triangles.size(), 1));
  Json coverage = Json::array();
  double last = 0.5;
  for (std::size_t k = levels.size() - 1; k > 0; --k) {
    last = std::min(last, static_cast<double>(levels[k - 1].triangles.size()) / finest);
    coverage.push_back(last);
  }
  coverage.push_back(0.0);
  return coverage;
}

// States that a mesh encloses a solid. Its vertices are shared already, so the manifold has the
// triangles of the mesh, and no vertices are merged.
Json manifold_extension(std::size_t positions, std::size_t indices) {
  return {{"EXT_mesh_manifold",
           {{"manifoldPrimitive",
             {{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", 4}}}}}};
}

struct Glb {
  Json json;
  std::string binary;
};

// The bounds of all levels: they share one translation.
Bounds box_of(const Hierarchy& hierarchy) {
  return bounds_of(hierarchy.mesh(hierarchy.levels.size() - 1).positions);
}

// The translation that a node adds to the stored positions.
Vec3 translation_of(const Hierarchy& hierarchy) {
  return hierarchy.float32_origin.value_or(float32_origin_of(box_of(hierarchy)));
}

Glb make_glb(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
             const std::filesystem::path& path) {
  const bool is_balanced = info.placement == Placement::balanced;
  const std::size_t level_count = hierarchy.levels.size();
  const Bounds box = box_of(hierarchy);
  const Vec3 translation = translation_of(hierarchy);
  const bool is_moved = translation != Vec3{};

  Buffer buffer;
  std::vector<Float3> shared;
  std::size_t shared_view = 0;
  Json nodes = Json::array();
  Json meshes = Json::array();
  bool any_closed = false;
  for (std::size_t k = level_count; k-- > 0;) {  // finest first
    const TriangleMesh mesh = hierarchy.mesh(k);
    // Levels share their vertices: each level uses the first ones of a common view.
    const bool has_own = !hierarchy.levels[k].own_positions.empty();
    std::vector<Float3> own;
    std::size_t position_view = shared_view;
    if (has_own || shared.empty()) {
      own = all_floats(mesh.positions, translation, path);
      position_view = buffer.add_view(own, kArrayBuffer);
      if (!has_own) {
        shared = own;
        shared_view = position_view;
      }
    }
    Json position = vec3_accessor(position_view, mesh.positions.size());
    add_range(position, own.empty() ? shared : own, mesh.positions.size());
    const std::size_t positions = buffer.add_accessor(std::move(position));
    const std::size_t normals = buffer.add_accessor(vec3_accessor(
        buffer.add_view(stored_normals(mesh, box), kArrayBuffer), mesh.positions.size()));
    Json attributes = {{"POSITION", positions}, {"NORMAL", normals}};
    if (const std::vector<float>& distance = hierarchy.levels[k].distance; !distance.empty()) {
      const std::size_t view = buffer.add_view(distance, kArrayBuffer);
      attributes["_MAX_DISTANCE"] = buffer.add_accessor({{"bufferView", view},
                                                         {"componentType", kFloat},
                                                         {"count", distance.size()},
                                                         {"type", "SCALAR"}});
    }
    const std::size_t indices =
        buffer.add_accessor({{"bufferView", buffer.add_view(mesh.triangles, kElementArrayBuffer)},
                             {"componentType", kUnsignedInt},
                             {"count", 3 * mesh.triangles.size()},
                             {"type", "SCALAR"}});

    const std::string name = "level " + std::to_string(k);
    Json gltf_mesh = {{"name", name},
                      {"primitives", Json::array({{{"attributes", std::move(attributes)},
                                                   {"indices", indices},
                                                   {"material", 0},
                                                   {"mode", 4}}})}};
    if (is_closed_manifold(mesh)) {
      gltf_mesh["extensions"] = manifold_extension(positions, indices);
      any_closed = true;
    }
    if (!info.levels.empty()) {
      gltf_mesh["extras"] = {{"isoatlas", Json::parse(info.levels[k])}};
    }
    meshes.push_back(std::move(gltf_mesh));
    Json node = {{"name", name}, {"mesh", meshes.size() - 1}};
    if (is_moved) {
      node["translation"] = {translation.x, translation.y, translation.z};
    }
    nodes.push_back(std::move(node));
  }
  if (level_count > 1) {
    Json ids = Json::array();
    for (std::size_t i = 1; i < level_count; ++i) {
      ids.push_back(i);
    }
    nodes[0]["extensions"] = {{"MSFT_lod", {{"ids", std::move(ids)}}}};
    nodes[0]["extras"] = {{"MSFT_screencoverage", screen_coverage(hierarchy.levels)}};
  }

  Glb glb;
  Json& json = glb.json;
  json["asset"] = {{"version", "2.0"}};
  if (!info.mesh.comment.empty()) {
    json["asset"]["generator"] = info.mesh.comment;
  }
  json["asset"]["extras"] = {{"isoatlas",
                              {{"space", info.mesh.space},
                               {"placement", is_balanced ? "balanced" : "surface"},
                               {"levels", level_count}}}};
  if (any_closed) {
    json["extensionsUsed"].push_back("EXT_mesh_manifold");
  }
  if (level_count > 1) {
    json["extensionsUsed"].push_back("MSFT_lod");
  }
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", {0}}}});
  json["nodes"] = std::move(nodes);
  json["meshes"] = std::move(meshes);
  // The default material of glTF is a metal. Both sides are drawn, because the back of an open
  // surface is visible.
  json["materials"] = Json::array({{{"name", "isosurface"},
                                    {"pbrMetallicRoughness",
                                     {{"baseColorFactor", {0.8, 0.8, 0.78, 1.0}},
                                      {"metallicFactor", 0.0},
                                      {"roughnessFactor", 0.6}}},
                                    {"doubleSided", true}}});
  json["accessors"] = std::move(buffer.accessors());
  json["bufferViews"] = std::move(buffer.views());
  json["buffers"] = Json::array({{{"byteLength", buffer.bytes().size()}}});
  glb.binary = std::move(buffer.bytes());
  return glb;
}

}  // namespace

std::vector<Vec3> positions_in_glb(const Hierarchy& hierarchy, std::size_t level,
                                   const std::filesystem::path& path) {
  return all_rounded(hierarchy.mesh(level).positions, translation_of(hierarchy), path);
}

double rounding_in_glb(const Hierarchy& hierarchy, const std::filesystem::path& path) {
  const Vec3 translation = translation_of(hierarchy);
  double largest = 0;
  for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) {
    largest = std::max(largest, largest_rounding(hierarchy.mesh(k).positions, translation, path));
  }
  return largest;
}

StoredPositions write_glb(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                          const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little, "glTF is little endian");
  AtomicFile file(path);
  {
    const Glb glb = make_glb(hierarchy, info, path);
    std::string json = glb.json.dump(-1, ' ', false, Json::error_handler_t::replace);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    constexpr std::size_t kHeaderBytes = 12;
    constexpr std::size_t kChunkHeaderBytes = 8;
    const std::uint64_t bytes =
        kHeaderBytes + 2 * kChunkHeaderBytes + json.size() + glb.binary.size();
    if (bytes > 0xFFFF'FFFFU) {
      throw unsupported(path, "not written: a .glb holds at most 4 GiB, these levels are " +
                                  std::to_string(bytes) + " bytes");
    }
    OutputBuffer out(file.stream());
    out.text("glTF");
    out.bytes(std::uint32_t{2});
    out.bytes(static_cast<std::uint32_t>(bytes));
    out.bytes(static_cast<std::uint32_t>(json.size()));
    out.text("JSON");
    out.text(json);
    out.bytes(static_cast<std::uint32_t>(glb.binary.size()));
    out.text({"BIN\0", 4});
    out.flush();
    file.stream().write(glb.binary.data(), static_cast<std::streamsize>(glb.binary.size()));
    file.flush();
  }

  StoredPositions stored{
      .single_precision = true, .space = info.mesh.space, .unit = info.mesh.unit};
  if (file.is_temporary()) {
    const StoredLevels read = read_glb(file_contents(file.written_path()), path);
    if (read.meshes.size() != hierarchy.levels.size()) {
      throw Error(
          ErrorCode::internal,
          one_line(path.string() + ": not written: read back, the number of levels differs"));
    }
    for (std::size_t k = 0; k < read.meshes.size(); ++k) {
      const double rounding = require_same_mesh(hierarchy.mesh(k), read.meshes[k], false, path,
                                                "level " + std::to_string(k));
      stored.largest_rounding = std::max(stored.largest_rounding, rounding);
    }
    require_rounding_within(rounding_in_glb(hierarchy, path), stored.largest_rounding, path);
  }
  file.commit();
  return stored;
}

}  // namespace isoatlas::detail::io
