// SPDX-License-Identifier: Apache-2.0
// 3D Manufacturing Format, core specification 1.3: a ZIP package with one XML part that holds the
// mesh. Not written by lib3mf, which keeps coordinates as floats and puts random identifiers into
// its files.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "files/memory_limit.h"
#include "files/number_text.h"
#include "mesh_files/formats.h"
#include "mesh_files/polygons.h"
#include "mesh_files/stored_form.h"
#include "mesh_files/xml_text.h"
#include "mesh_files/zip_archive.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kContentTypes = "[Content_Types].xml";
constexpr const char* kRelationships = "_rels/.rels";
constexpr const char* kModel = "3D/3dmodel.model";
constexpr const char* kModelType = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
constexpr const char* kCoreNamespace = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
constexpr const char* kSpaceName = "isoatlas:space";
constexpr const char* kProgramName = "Application";

constexpr std::array kUnits{
    std::pair{"micron", LengthUnit::micrometre}, std::pair{"millimeter", LengthUnit::millimetre},
    std::pair{"centimeter", LengthUnit::centimetre}, std::pair{"inch", LengthUnit::inch},
    std::pair{"meter", LengthUnit::metre}};

// ----------------------------------------------------------------------------------------- writing

// Appends the shortest digits that read back as the same number.
template <class Number>
void append(std::string& text, Number number) {
  std::array<char, 32> digits{};
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), result.ptr);
}

// Appends elements like <vertex x="1" y="2" z="3"/>, one per line.
template <class Number>
void append_element(std::string& text, const std::array<std::string_view, 4>& parts,
                    const std::array<Number, 3>& values) {
  for (std::size_t i = 0; i < 3; ++i) {
    text += parts[i];
    append(text, values[i]);
  }
  text += parts[3];
}

std::string model_xml(const TriangleMesh& mesh, const MeshFileInfo& info) {
  const auto unit =
      std::ranges::find(kUnits, info.unit, [](const auto& entry) { return entry.second; });
  std::string xml = R"(<?xml version="1.0" encoding="UTF-8"?>)"
                    "\n"
                    R"(<model unit=")";
  xml += unit == kUnits.end() ? "millimeter" : unit->first;
  xml += R"(" xml:lang="en-US" xmlns=")";
  xml += kCoreNamespace;
  xml += R"(" xmlns:isoatlas="urn:isoatlas:mesh">)"
         "\n";
  for (const auto& [name, value] :
       {std::pair{kProgramName, info.comment}, std::pair{kSpaceName, info.space}}) {
    if (!value.empty()) {
      xml += std::string("<metadata name=\"") + name + "\">" + xml_text(value) + "</metadata>\n";
    }
  }
  // The specification requires a "model" to be closed; a "surface" may be open.
  xml += R"(<resources>)"
         "\n"
         R"(<object id="1" type=")";
  xml += is_closed_manifold(mesh) ? "model" : "surface";
  xml += "\">\n<mesh>\n<vertices>\n";
  for (const Vec3& p : mesh.positions) {
    append_element<double>(xml, {"<vertex x=\"", "\" y=\"", "\" z=\"", "\"/>\n"}, {p.x, p.y, p.z});
  }
  xml += "</vertices>\n<triangles>\n";
  for (const Triangle& t : mesh.triangles) {
    append_element<std::uint32_t>(xml, {"<triangle v1=\"", "\" v2=\"", "\" v3=\"", "\"/>\n"}, t);
  }
  xml +=
      "</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item "
      "objectid=\"1\"/>\n</build>\n</model>\n";
  return xml;
}

std::string content_types_xml() {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";
}

std::string relationships_xml() {
  return std::string(R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="rel0" Type=")") +
         kModelType + R"(" Target="/)" + kModel + R"("/>
</Relationships>
)";
}

// ----------------------------------------------------------------------------------------- reading

pugi::xml_document parsed(std::string& xml, unsigned int options, const std::string& part,
                          const fs::path& path) {
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer_inplace(xml.data(), xml.size(), options);
  if (!result && result.status == pugi::status_out_of_memory) {
    throw out_of_memory(path, xml.size());
  }
  if (!result) {
    throw bad_file(path, "its part " + part + " is not XML: " + result.description());
  }
  return document;
}

// The root element, or null if it is not a model. If the core namespace has a prefix, it is removed
// from the element names.
pugi::xml_node model_in(pugi::xml_document& document) {
  const pugi::xml_node root = document.document_element();
  const std::string name = root.name();
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos) {
    return document.child("model");
  }
  const std::string prefix = name.substr(0, colon + 1);
  if (name.substr(colon + 1) != "model" ||
      std::string_view(root.attribute(("xmlns:" + name.substr(0, colon)).c_str()).value()) !=
          kCoreNamespace) {
    return {};
  }
  struct Walker final : pugi::xml_tree_walker {
    explicit Walker(const std::string& text) : prefix(text) {}
    bool for_each(pugi::xml_node& node) override {
      const std::string full = node.name();
      return !full.starts_with(prefix) || node.set_name(full.c_str() + prefix.size());
    }
    const std::string& prefix;
  } walker(prefix);
  document.traverse(walker);
  return root;
}

// Extensions for colours and identifiers can be ignored; those for slices, beams, encryption and
// others change the mesh.
void require_known_extensions(const pugi::xml_node& model, const fs::path& path) {
  constexpr std::array<std::string_view, 4> kKnown{
      kCoreNamespace, "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
      "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
      "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};
  std::istringstream prefixes(model.attribute("requiredextensions").value());
  for (std::string prefix; prefixes >> prefix;) {
    const std::string name = model.attribute(("xmlns:" + prefix).c_str()).value();
    if (std::ranges::find(kKnown, name) == kKnown.end()) {
      throw unsupported(path, "needs the 3MF extension " +
                                  one_line(name.empty() ? prefix : name, 100) +
                                  ", which isoatlas does not read; save it without the extension");
    }
  }
}

// The path of the model part that the package names.
std::string model_part(const ZipReader& archive, const fs::path& path) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 20;
  std::string xml = archive.part(kRelationships, kMostBytes);
  const pugi::xml_document document = parsed(xml, pugi::parse_default, kRelationships, path);
  for (const pugi::xml_node relationship :
       document.child("Relationships").children("Relationship")) {
    if (std::string(relationship.attribute("Type").value()) == kModelType) {
      const std::string target = relationship.attribute("Target").value();
      return target.starts_with('/') ? target.substr(1) : target;
    }
  }
  throw bad_file(path, "is not a 3MF file: its package names no 3-D model");
}

// Reads the decimal number at the beginning of `text` and removes it from `text`.
template <class Number>
bool take_number(std::string_view& text, Number& number) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  text.remove_prefix(first == std::string_view::npos ? text.size() : first);
  const auto [end, error] = leading_number(text, number);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc();
}

/// Reads `text` as one number; false if it is anything else.
template <class Number>
bool take_only_number(std::string_view text, Number& number) {
  return take_number(text, number) && text.find_first_not_of(" \t\r\n") == std::string_view::npos;
}

// An affine transform, its rows in the order of the file: p * rows[0..2] + rows[3].
using Transform = std::array<Vec3, 4>;

constexpr Transform kIdentity{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{}};

Vec3 apply_linear_part(const Vec3& p, const Transform& t) {
  return {p.x * t[0].x + p.y * t[1].x + p.z * t[2].x, p.x * t[0].y + p.y * t[1].y + p.z * t[2].y,
          p.x * t[0].z + p.y * t[1].z + p.z * t[2].z};
}

Vec3 apply(const Transform& t, const Vec3& p) {
  const Vec3 q = apply_linear_part(p, t);
  return {q.x + t[3].x, q.y + t[3].y, q.z + t[3].z};
}

// The transform that applies `inner` first, then `outer`.
Transform compose(const Transform& inner, const Transform& outer) {
  return {apply_linear_part(inner[0], outer), apply_linear_part(inner[1], outer),
          apply_linear_part(inner[2], outer), apply(outer, inner[3])};
}

bool is_mirroring(const Transform& t) {
  const Vec3 cross{t[1].y * t[2].z - t[1].z * t[2].y, t[1].z * t[2].x - t[1].x * t[2].z,
                   t[1].x * t[2].y - t[1].y * t[2].x};
  return t[0].x * cross.x + t[0].y * cross.y + t[0].z * cross.z < 0;
}

class ModelReader {
 public:
  ModelReader(const pugi::xml_node& model, const fs::path& path) : path_(path) {
    for (const pugi::xml_node object : model.child("resources").children("object")) {
      objects_[object.attribute("id").value()] = object;
    }
    for (const pugi::xml_node item : model.child("build").children("item")) {
      add_object(item, kIdentity, 0);
    }
  }

  TriangleMesh mesh() { return std::move(mesh_); }

 private:
  // Adds the mesh of an object. `reference` is the element that names the object and its transform.
  void add_object(const pugi::xml_node& reference, const Transform& outer, int depth) {
    constexpr int kMostDepth = 32;
    constexpr std::size_t kMostPlaced =
        1'000'000;  // a few nested components can make any number of copies
    for (const pugi::xml_attribute attribute :
         reference.attributes()) {  // paths to other parts come from the production extension
      if (std::string_view(attribute.name()).ends_with(":path")) {
        throw unsupported(
            path_,
            "keeps its meshes in several parts, expected all of them in one, as in the "
            "core specification");
      }
    }
    const std::string id = reference.attribute("objectid").value();
    const auto object = objects_.find(id);
    if (object == objects_.end()) {
      throw bad_file(path_, "has no object " + one_line(id, 40) + ", which it uses");
    }
    if (depth > kMostDepth || ++placed_ > kMostPlaced) {
      throw bad_file(path_, depth > kMostDepth ? "its objects are nested too deeply"
                                               : "its objects are used too often");
    }
    const Transform transform = compose(transform_of(reference), outer);
    if (const pugi::xml_node mesh = object->second.child("mesh")) {
      add_mesh(mesh, transform);
    }
    for (const pugi::xml_node component :
         object->second.child("components").children("component")) {
      add_object(component, transform, depth + 1);
    }
  }

  Transform transform_of(const pugi::xml_node& reference) const {
    const pugi::xml_attribute attribute = reference.attribute("transform");
    if (!attribute) {
      return kIdentity;
    }
    std::string_view text = attribute.value();
    Transform transform{};
    for (Vec3& row : transform) {
      if (!take_number(text, row.x) || !take_number(text, row.y) || !take_number(text, row.z)) {
        throw bad_file(path_, "has a transform '" + one_line(attribute.value(), 80) +
                                  "', expected twelve numbers");
      }
    }
    return transform;
  }

  void add_mesh(const pugi::xml_node& mesh, const Transform& transform) {
    const std::size_t first = mesh_.positions.size();
    for (const pugi::xml_node vertex : mesh.child("vertices").children("vertex")) {
      const Vec3 p{coordinate(vertex, "x"), coordinate(vertex, "y"), coordinate(vertex, "z")};
      mesh_.positions.push_back(transform == kIdentity ? p : apply(transform, p));
    }
    const bool is_mirrored = is_mirroring(transform);
    for (const pugi::xml_node triangle : mesh.child("triangles").children("triangle")) {
      const std::size_t count = mesh_.positions.size() - first;
      Triangle t{corner(triangle, "v1", first, count), corner(triangle, "v2", first, count),
                 corner(triangle, "v3", first, count)};
      if (is_mirrored) {
        std::swap(t[1], t[2]);
      }
      mesh_.triangles.push_back(t);
    }
    require_memory();
  }

  double coordinate(const pugi::xml_node& vertex, const char* name) const {
    double value = 0;
    if (!take_only_number(vertex.attribute(name).value(), value)) {
      throw bad_file(path_, std::string("the ") + name + " coordinate of a vertex is '" +
                                one_line(vertex.attribute(name).value(), 40) +
                                "', expected a number");
    }
    return value;
  }

  std::uint32_t corner(const pugi::xml_node& triangle, const char* name, std::size_t first,
                       std::size_t count) const {
    std::uint32_t value = 0;
    if (!take_only_number(triangle.attribute(name).value(), value) || value >= count) {
      throw bad_file(path_, std::string("a triangle has the corner ") + name + "='" +
                                one_line(triangle.attribute(name).value(), 40) +
                                "', expected one of " + std::to_string(count) + " vertices");
    }
    return vertex_index(static_cast<std::int64_t>(first + value));
  }

  void require_memory() const {
    const std::uint64_t bytes =
        mesh_.positions.size() * sizeof(Vec3) + mesh_.triangles.size() * sizeof(Triangle);
    if (bytes > most_bytes_ || mesh_.positions.size() >= kIndexOutOfRange) {
      throw out_of_memory(path_, bytes);
    }
  }

  const fs::path& path_;
  std::map<std::string, pugi::xml_node> objects_;
  const std::uint64_t most_bytes_ = default_memory_limit() / 4;
  std::size_t placed_ = 0;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh read_3mf(const fs::path& path) {
  constexpr std::uint64_t kTreePerByte =
      20;  // memory of the parsed "<a/>" divided by the size of its text
  const ZipReader archive(path);
  const std::string part = model_part(archive, path);
  std::string xml = archive.part(part, default_memory_limit() / kTreePerByte);
  pugi::xml_document document = parsed(xml, pugi::parse_minimal, part, path);
  const pugi::xml_node model = model_in(document);
  if (!model) {
    throw bad_file(path, "is not a 3MF file: its part " + one_line(part, 80) + " has no model");
  }
  require_known_extensions(model, path);
  return ModelReader(model, path).mesh();
}

MeshFileInfo info_in_3mf(const fs::path& path) {
  constexpr std::uint64_t kBeginning = 65536;  // metadata precede the meshes
  const ZipReader archive(path);
  const std::string part = model_part(archive, path);
  std::string xml = archive.beginning_of_part(part, kBeginning);
  xml.resize(std::min({xml.find("<resources"), xml.find(":resources"), xml.size()}));
  pugi::xml_document document;
  document.load_buffer(xml.data(),
                       xml.size());  // parses as far as it can: the text ends within the model
  const pugi::xml_node model = model_in(document);
  MeshFileInfo info;
  const std::string unit = model.attribute("unit").value();
  const auto found = std::ranges::find(
      kUnits, unit, [](const auto& entry) { return std::string_view(entry.first); });
  info.unit = unit.empty()            ? LengthUnit::millimetre
              : found == kUnits.end() ? LengthUnit::unknown
                                      : found->second;
  for (const pugi::xml_node metadata : model.children("metadata")) {
    const std::string name = metadata.attribute("name").value();
    if (name == kSpaceName) {
      info.space = metadata.child_value();
    } else if (name == kProgramName) {
      info.comment = metadata.child_value();
    }
  }
  return info;
}

void write_3mf(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  const std::string bytes = zip_bytes({{kContentTypes, content_types_xml()},
                                       {kRelationships, relationships_xml()},
                                       {kModel, model_xml(mesh, info)}},
                                      file.destination());
  file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace isoatlas::detail::io
