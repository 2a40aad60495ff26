// SPDX-License-Identifier: Apache-2.0
// Reads levels of detail from binary glTF, by tinygltf. Shares no code with the writer, whose files
// it checks.
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "core/vector_math.h"
#include "files/file_error.h"
#include "mesh_files/formats.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

std::uint32_t number_at(const std::string& contents, std::size_t offset) {
  std::uint32_t number = 0;
  std::memcpy(&number, contents.data() + offset, sizeof number);
  return number;
}

// Checks what tinygltf does not check before it reads: the length in the header, and the nesting of
// lists, into which it recurses.
void require_container(const std::string& contents, const fs::path& path) {
  constexpr std::size_t kJsonStart = 20;
  constexpr int kMostDepth = 64;
  if (contents.size() < kJsonStart || !contents.starts_with("glTF")) {
    throw bad_file(path, "is not a binary glTF file");
  }
  if (number_at(contents, 8) != contents.size()) {
    throw bad_file(path, "states " + std::to_string(number_at(contents, 8)) + " bytes, but has " +
                             std::to_string(contents.size()));
  }
  if (number_at(contents, 12) > contents.size() - kJsonStart) {
    throw bad_file(path, "is cut off: its JSON ends too early");
  }
  int depth = 0;
  bool is_text = false;
  for (std::size_t i = kJsonStart; i < kJsonStart + number_at(contents, 12); ++i) {
    const char c = contents[i];
    if (is_text) {
      i += c == '\\';
      is_text = c != '"';
    } else if (c == '"') {
      is_text = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kMostDepth) {
        throw bad_file(path, "its JSON is nested too deeply");
      }
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

// Extensions for appearance can be ignored; extensions that move vertices or store them differently
// cannot.
void require_known_extensions(const std::string& contents, const fs::path& path) {
  constexpr std::size_t kJson = 20;  // after the file's and the chunk's headers
  std::uint32_t bytes = 0;
  if (contents.size() < kJson) return;  // require_container has reported it
  std::memcpy(&bytes, contents.data() + 12, sizeof bytes);
  const nlohmann::json json = nlohmann::json::parse(contents.substr(kJson, bytes), nullptr, false);
  if (!json.is_object() || !json.contains("extensionsRequired") ||
      !json["extensionsRequired"].is_array())
    return;
  for (const nlohmann::json& extension : json["extensionsRequired"]) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : "";
    constexpr std::array<std::string_view, 6> kKnown{"KHR_materials_", "KHR_texture_",
                                                     "EXT_texture_",   "KHR_lights_",
                                                     "MSFT_lod",       "EXT_mesh_manifold"};
    if (std::ranges::none_of(kKnown,
                             [&](std::string_view known) { return name.starts_with(known); })) {
      throw unsupported(path,
                        "needs the glTF extension " + one_line(name, 80) +
                            ", which isoatlas does not read; export it without the extension");
    }
  }
}

tinygltf::Model load(std::string contents, const fs::path& path) {
  require_container(contents, path);
  require_known_extensions(contents, path);
  tinygltf::TinyGLTF loader;
  // Reads this file only: files that it names are not opened, and pictures are not decoded.
  tinygltf::FsCallbacks files{};
  files.FileExists = [](const std::string&, void*) { return false; };
  files.ExpandFilePath = [](const std::string& name, void*) { return name; };
  files.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) {
    return false;
  };
  files.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&,
                            void*) { return false; };
  loader.SetFsCallbacks(files);
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int,
                           const unsigned char*, int, void*) { return true; },
                        nullptr);
  loader.SetStoreOriginalJSONForExtrasAndExtensions(true);
  tinygltf::Model model;
  std::string error;
  std::string warning;
  const auto size = static_cast<unsigned int>(contents.size());
  if (!loader.LoadBinaryFromMemory(&model, &error, &warning,
                                   reinterpret_cast<const unsigned char*>(contents.data()), size)) {
    throw bad_file(path, "is not a glTF 2.0 file: " + one_line(error));
  }
  return model;
}

class Reader {
 public:
  Reader(const tinygltf::Model& model, const fs::path& path) : model_(model), path_(path) {}

  StoredLevels read() const {
    StoredLevels levels;
    const PlacedNode place = finest_node();
    const tinygltf::Node& finest = node(place.index);
    std::vector<const tinygltf::Node*> nodes{&finest};
    if (const auto lod = finest.extensions.find("MSFT_lod");
        lod != finest.extensions.end() && lod->second.Has("ids")) {
      const tinygltf::Value& ids = lod->second.Get("ids");
      for (std::size_t i = 0; i < ids.ArrayLen(); ++i) {
        nodes.push_back(&node(ids.Get(static_cast<int>(i)).IsInt()
                                  ? ids.Get(static_cast<int>(i)).GetNumberAsInt()
                                  : -1));
      }
    }
    std::ranges::reverse(nodes);  // the extension lists the finest first
    bool any_json = false;
    for (const tinygltf::Node* n : nodes) {
      const tinygltf::Mesh& mesh = at(model_.meshes, n->mesh, "mesh");
      require_stored_shape(*n, mesh);
      levels.meshes.push_back(mesh_of(mesh, place.parent + translation_of(*n)));
      levels.distances.push_back(distance_of(mesh));
      levels.info.levels.push_back(isoatlas_extras(mesh.extras_json_string).dump());
      any_json = any_json || levels.info.levels.back() != "null";
    }
    if (!any_json) {
      levels.info.levels.clear();
    }
    const nlohmann::json about = isoatlas_extras(model_.asset.extras_json_string);
    if (about.contains("space") && about["space"].is_string()) {
      about["space"].get_to(levels.info.mesh.space);
    }
    if (about.contains("placement") && about["placement"] == "balanced") {
      levels.info.placement = Placement::balanced;
    }
    levels.info.mesh.comment = model_.asset.generator;
    return levels;
  }

 private:
  template <class Item>
  const Item& at(const std::vector<Item>& items, int index, const char* missing) const {
    if (index < 0 || static_cast<std::size_t>(index) >= items.size()) {
      throw bad_file(path_, std::string("names a ") + missing + " that it does not have");
    }
    return items[static_cast<std::size_t>(index)];
  }

  // Morph targets and skeletons move vertices away from the stored positions.
  void require_stored_shape(const tinygltf::Node& n, const tinygltf::Mesh& mesh) const {
    const std::vector<double>& weights = n.weights.empty() ? mesh.weights : n.weights;
    if (std::ranges::any_of(weights, [](double weight) { return weight != 0; })) {
      throw unsupported(path_, "has a mesh that morph targets move, expected weights of 0");
    }
    if (n.skin >= 0) {
      throw unsupported(path_, "has a mesh that a skeleton moves (skin), expected one without");
    }
  }

  const tinygltf::Node& node(int index) const { return at(model_.nodes, index, "node"); }

  struct PlacedNode {
    int index = -1;
    Vec3 parent;  // translation of the parent node
  };

  // Finds the only node of the scene with a mesh. There may be cameras, lights and empty nodes
  // beside and around it.
  PlacedNode finest_node() const {
    std::vector<PlacedNode> open, found;
    if (model_.scenes.empty()) {  // without scenes, all nodes belong to the scene
      std::vector<bool> is_child(model_.nodes.size());
      for (const tinygltf::Node& n : model_.nodes) {
        for (const int child : n.children) {
          node(child);  // throws if it does not exist
          is_child[static_cast<std::size_t>(child)] = true;
        }
      }
      for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
        if (!is_child[i]) open.push_back({static_cast<int>(i), {}});
      }
    } else {
      for (const int root : at(model_.scenes, std::max(model_.defaultScene, 0), "scene").nodes)
        open.push_back({root, {}});
    }
    std::size_t visits = 0;
    while (!open.empty() && found.size() < 2) {
      const PlacedNode next = open.back();
      open.pop_back();
      const tinygltf::Node& n = node(next.index);
      if (++visits > model_.nodes.size()) {
        throw bad_file(path_, "has a node that is its own ancestor, or has two parents");
      }
      if (n.mesh >= 0) found.push_back(next);
      if (!n.children.empty()) {
        const Vec3 position = next.parent + translation_of(n);
        for (const int child : n.children) open.push_back({child, position});
      }
    }
    if (found.size() != 1) {
      throw unsupported(
          path_,
          found.empty()
              ? std::string("has a scene without a mesh")
              : std::string(
                    "has a scene of several meshes, expected one mesh and its levels of detail"));
    }
    return found.front();
  }

  Vec3 translation_of(const tinygltf::Node& n) const {
    constexpr std::array<double, 16> kUnitMatrix{1, 0, 0, 0, 0, 1, 0, 0,
                                                 0, 0, 1, 0, 0, 0, 0, 1};  // column by column
    const bool turns = !n.rotation.empty() && n.rotation != std::vector<double>{0, 0, 0, 1};
    const bool scales = !n.scale.empty() && n.scale != std::vector<double>{1, 1, 1};
    const bool has_matrix = n.matrix.size() == kUnitMatrix.size();
    bool is_plain = !turns && !scales;
    for (std::size_t i = 0; has_matrix && i < kUnitMatrix.size(); ++i)
      is_plain = is_plain && ((i >= 12 && i < 15) || n.matrix[i] == kUnitMatrix[i]);
    if (!is_plain) {
      throw unsupported(path_, "has a node that is rotated or scaled, expected translations only");
    }
    if (has_matrix) return {n.matrix[12], n.matrix[13], n.matrix[14]};
    return n.translation.size() == 3 ? Vec3{n.translation[0], n.translation[1], n.translation[2]}
                                     : Vec3{};
  }

  // The part of an object's `extras` that isoatlas wrote; null if it is missing.
  nlohmann::json isoatlas_extras(const std::string& extras) const {
    const nlohmann::json json = nlohmann::json::parse(extras, nullptr, false);
    return json.is_object() && json.contains("isoatlas") && json["isoatlas"].is_object()
               ? json["isoatlas"]
               : nlohmann::json();
  }

  struct Elements {
    const unsigned char* first;
    std::size_t count, stride;
  };

  Elements elements(int index, int type, std::size_t element_bytes) const {
    const tinygltf::Accessor& accessor = at(model_.accessors, index, "accessor");
    if (accessor.type != type || accessor.sparse.isSparse || accessor.normalized) {
      throw unsupported(path_, "has an accessor of a kind that isoatlas does not write");
    }
    if (accessor.bufferView < 0) {
      throw unsupported(path_, "has an accessor without a buffer view");
    }
    const tinygltf::BufferView& view = at(model_.bufferViews, accessor.bufferView, "buffer view");
    const std::vector<unsigned char>& bytes = at(model_.buffers, view.buffer, "buffer").data;
    const std::size_t stride = view.byteStride == 0 ? element_bytes : view.byteStride;
    const std::size_t count = accessor.count;
    const bool fits =
        view.byteOffset <= bytes.size() && view.byteLength <= bytes.size() - view.byteOffset &&
        stride >= element_bytes && accessor.byteOffset <= view.byteLength &&
        (count == 0 ||
         (view.byteLength - accessor.byteOffset >= element_bytes &&
          (count - 1) <= (view.byteLength - accessor.byteOffset - element_bytes) / stride));
    if (!fits) {
      throw bad_file(path_, "has an accessor with more elements than its data");
    }
    return {bytes.data() + view.byteOffset + accessor.byteOffset, count, stride};
  }

  TriangleMesh mesh_of(const tinygltf::Mesh& gltf_mesh, Vec3 translation) const {
    if (gltf_mesh.primitives.size() != 1) {
      throw unsupported(path_, "has a mesh of " + std::to_string(gltf_mesh.primitives.size()) +
                                   " primitives, expected one");
    }
    const tinygltf::Primitive& primitive = gltf_mesh.primitives[0];
    const auto position = primitive.attributes.find("POSITION");
    if ((primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1) ||
        position == primitive.attributes.end() || primitive.indices < 0) {
      throw unsupported(path_, "has a mesh that is not a list of triangles with indices");
    }
    TriangleMesh mesh;
    if (at(model_.accessors, position->second, "accessor").componentType !=
        TINYGLTF_COMPONENT_TYPE_FLOAT) {
      throw unsupported(path_, "has positions that are not float");
    }
    const Elements positions = elements(position->second, TINYGLTF_TYPE_VEC3, 3 * sizeof(float));
    mesh.positions.reserve(positions.count);
    for (std::size_t v = 0; v < positions.count; ++v) {
      std::array<float, 3> p{};
      std::memcpy(p.data(), positions.first + v * positions.stride, sizeof p);
      mesh.positions.push_back({p[0] + translation.x, p[1] + translation.y, p[2] + translation.z});
    }
    append_triangles(mesh, primitive.indices);
    return mesh;
  }

  std::vector<float> distance_of(const tinygltf::Mesh& gltf_mesh) const {
    const auto attribute = gltf_mesh.primitives[0].attributes.find("_MAX_DISTANCE");
    if (attribute == gltf_mesh.primitives[0].attributes.end() ||
        at(model_.accessors, attribute->second, "accessor").componentType !=
            TINYGLTF_COMPONENT_TYPE_FLOAT) {
      return {};
    }
    const Elements values = elements(attribute->second, TINYGLTF_TYPE_SCALAR, sizeof(float));
    std::vector<float> result(values.count);
    for (std::size_t v = 0; v < values.count; ++v) {
      std::memcpy(&result[v], values.first + v * values.stride, sizeof(float));
    }
    return result;
  }

  void append_triangles(TriangleMesh& mesh, int accessor) const {
    const int type = at(model_.accessors, accessor, "accessor").componentType;
    const std::size_t bytes = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT     ? 4
                              : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                              : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE  ? 1
                                                                               : 0;
    if (bytes == 0) {
      throw unsupported(path_, "has indices that are not unsigned integers");
    }
    const Elements indices = elements(accessor, TINYGLTF_TYPE_SCALAR, bytes);
    if (indices.count % 3 != 0) {
      throw bad_file(path_, "has a list of triangles that ends within a triangle");
    }
    mesh.triangles.resize(indices.count / 3);
    for (std::size_t i = 0; i < indices.count; ++i) {
      std::uint32_t index = 0;
      std::memcpy(&index, indices.first + i * indices.stride,
                  bytes);  // little endian, as this machine
      mesh.triangles[i / 3][i % 3] = index;
    }
  }

  const tinygltf::Model& model_;
  const fs::path& path_;
};

}  // namespace

StoredLevels read_glb(const fs::path& path) { return read_glb(file_contents(path), path); }

StoredLevels read_glb(std::string contents, const fs::path& path) {
  const tinygltf::Model model = load(std::move(contents), path);
  return Reader(model, path).read();
}

}  // namespace isoatlas::detail::io
