// SPDX-License-Identifier: Apache-2.0
// Stanford PLY. Written in binary little endian with double positions; read in all three encodings.
//
// VTK's PLY reader and writer are not used: they keep float positions. In scanner coordinates, 1000
// mm from the origin, that loses everything below 0.0001 mm, and two vertices of a small triangle
// can become equal.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <string>

#include "files/file_error.h"
#include "files/text_scanner.h"
#include "mesh_files/formats.h"
#include "mesh_files/output_buffer.h"
#include "mesh_files/polygons.h"

namespace isoatlas::detail::io {

namespace {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType>
      list_count_type;  // set if the property is a list, which begins with its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0, lines = 0;  // size of the header
};

PlyType ply_type(const TextScanner& scanner, std::string_view word) {
  struct Name {
    std::string_view old_name, new_name;
    PlyType type;
  };
  static constexpr std::array kNames{
      Name{"char", "int8", PlyType::int8},        Name{"uchar", "uint8", PlyType::uint8},
      Name{"short", "int16", PlyType::int16},     Name{"ushort", "uint16", PlyType::uint16},
      Name{"int", "int32", PlyType::int32},       Name{"uint", "uint32", PlyType::uint32},
      Name{"float", "float32", PlyType::float32}, Name{"double", "float64", PlyType::float64},
  };
  for (const Name& name : kNames) {
    if (word == name.old_name || word == name.new_name) {
      return name.type;
    }
  }
  throw scanner.error("unknown property type '" + one_line(word, 40) + "'");
}

std::size_t bytes_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

PlyHeader read_header(const std::string& contents, const std::filesystem::path& path) {
  TextScanner scanner(contents, path);
  PlyHeader header;
  if (!scanner.next_line() || scanner.word() != "ply") {
    throw bad_file(path, "is not a PLY file");
  }
  bool has_format = false;
  for (;;) {
    if (!scanner.next_line()) {
      throw scanner.error("the file ends in its header");
    }
    const std::string_view keyword = scanner.word();
    if (keyword == "format") {
      const std::string_view encoding = scanner.word();
      if (encoding == "ascii") {
        header.encoding = PlyEncoding::ascii;
      } else if (encoding == "binary_little_endian") {
        header.encoding = PlyEncoding::little_endian;
      } else if (encoding == "binary_big_endian") {
        header.encoding = PlyEncoding::big_endian;
      } else {
        throw scanner.error("unknown format '" + one_line(encoding, 40) + "'");
      }
      has_format = true;
    } else if (keyword == "element") {
      PlyElement element;
      element.name = scanner.word();
      const std::int64_t count = scanner.integer("the number of elements");
      if (count < 0) {
        throw scanner.error("a negative number of elements");
      }
      element.count = static_cast<std::uint64_t>(count);
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) {
        throw scanner.error("a property before any element");
      }
      PlyProperty property;
      std::string_view type = scanner.word();
      if (type == "list") {
        property.list_count_type = ply_type(scanner, scanner.word());
        type = scanner.word();
      }
      property.type = ply_type(scanner, type);
      property.name = scanner.word();
      header.elements.back().properties.push_back(std::move(property));
    } else if (keyword == "end_header") {
      break;
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      throw scanner.error("found '" + one_line(keyword, 40) + "', expected a line of a PLY header");
    }
  }
  if (!has_format) {
    throw scanner.error("the header has no format line");
  }
  header.bytes = contents.size() - scanner.remaining();
  header.lines = scanner.line_number();
  return header;
}

// Reads the values of the body in order. Every value of every PLY type is exact as a double.
class AsciiValues {
 public:
  AsciiValues(std::string_view body, const std::filesystem::path& path, std::size_t lines_before)
      : scanner_(body, path, lines_before) {}
  double next(PlyType) { return scanner_.to_number(scanner_.next_word(), "a number"); }
  // Always possible: nothing is allocated in advance, and the end of the text is reported where it
  // is reached.
  std::uint64_t most_values(PlyType) const { return std::numeric_limits<std::uint64_t>::max(); }

 private:
  TextScanner scanner_;
};

class BinaryValues {
 public:
  BinaryValues(std::string_view body, bool big_endian, const std::filesystem::path& path)
      : rest_(body), swap_(big_endian != (std::endian::native == std::endian::big)), path_(path) {}

  double next(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>();
      case PlyType::uint8:
        return take<std::uint8_t>();
      case PlyType::int16:
        return take<std::int16_t>();
      case PlyType::uint16:
        return take<std::uint16_t>();
      case PlyType::int32:
        return take<std::int32_t>();
      case PlyType::uint32:
        return take<std::uint32_t>();
      case PlyType::float32:
        return take<float>();
      case PlyType::float64:
        break;
    }
    return take<double>();
  }
  std::uint64_t most_values(PlyType type) const { return rest_.size() / bytes_of(type); }

 private:
  template <class Value>
  Value take() {
    std::array<char, sizeof(Value)> bytes;
    if (rest_.size() < bytes.size()) {
      throw bad_file(path_, "ends in the middle of its data");
    }
    std::copy_n(rest_.begin(), bytes.size(), bytes.begin());
    rest_.remove_prefix(bytes.size());
    if (swap_) {
      std::reverse(bytes.begin(), bytes.end());
    }
    return std::bit_cast<Value>(bytes);
  }

  std::string_view rest_;
  bool swap_;
  const std::filesystem::path& path_;
};

bool is_vertex_list(const PlyProperty& property) {
  return property.list_count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index" ||
          property.name == "vertex_indexes");
}

std::int64_t to_index(double value) {
  return value >= 0 && value < 4294967295.0 &&
                 value == static_cast<double>(static_cast<std::int64_t>(value))
             ? static_cast<std::int64_t>(value)
             : -1;
}

template <class Values>
TriangleMesh read_body(Values& values, const PlyHeader& header, const std::filesystem::path& path) {
  TriangleMesh mesh;
  PolygonCutter polygons(mesh);
  std::vector<std::uint32_t> corners;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) {
      continue;  // elements without properties have no data
    }
    const bool is_vertex = element.name == "vertex";
    const bool is_face = element.name == "face";
    const PlyProperty& first = element.properties.front();
    if (element.count > values.most_values(first.list_count_type.value_or(first.type))) {
      throw bad_file(path, "states " + std::to_string(element.count) + " elements '" +
                               one_line(element.name, 40) + "', the file is too short for them");
    }
    if (is_vertex) {
      for (const std::string_view axis : {"x", "y", "z"}) {
        if (std::ranges::none_of(element.properties, [&](const PlyProperty& p) {
              return p.name == axis && !p.list_count_type;
            })) {
          throw bad_file(path, "its vertices have no " + std::string(axis) + " coordinate");
        }
      }
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      Vec3 position;
      for (const PlyProperty& property : element.properties) {
        if (!property.list_count_type) {
          const double value = values.next(property.type);
          if (property.name == "x") {
            position.x = value;
          } else if (property.name == "y") {
            position.y = value;
          } else if (property.name == "z") {
            position.z = value;
          }
          continue;
        }
        const double count = values.next(*property.list_count_type);
        if (!(count >= 0)) {
          throw bad_file(path, "has a list of negative length");
        }
        corners.clear();
        for (double k = 0; k < count; ++k) {
          corners.push_back(vertex_index(to_index(values.next(property.type))));
        }
        if (is_face && is_vertex_list(property)) {
          polygons.append(corners);
        }
      }
      if (is_vertex) {
        mesh.positions.push_back(position);
      }
    }
  }
  polygons.cut_concave();
  return mesh;
}

}  // namespace

TriangleMesh read_ply(const std::filesystem::path& path) {
  const std::string contents = file_contents(path);
  const PlyHeader header = read_header(contents, path);
  const bool has_strips = std::ranges::any_of(header.elements, [](const PlyElement& element) {
    return element.name == "tristrips" && element.count > 0;
  });
  if (has_strips) {
    throw unsupported(path, "holds triangle strips, expected faces");
  }
  const std::string_view body = std::string_view(contents).substr(header.bytes);
  if (header.encoding == PlyEncoding::ascii) {
    AsciiValues values(body, path, header.lines);
    return read_body(values, header, path);
  }
  BinaryValues values(body, header.encoding == PlyEncoding::big_endian, path);
  return read_body(values, header, path);
}

void write_ply(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  static_assert(std::endian::native == std::endian::little,
                "positions and indices are written as they are in memory");
  OutputBuffer out(file.stream());
  out.text("ply\nformat binary_little_endian 1.0\n");
  for (const std::string& comment :
       {info.comment, info.space.empty() ? "" : "SPACE=" + info.space}) {
    if (!comment.empty()) {
      out.text("comment " + comment + "\n");
    }
  }
  out.text("element vertex " + std::to_string(mesh.positions.size()) + "\n");
  out.text("property double x\nproperty double y\nproperty double z\n");
  out.text("element face " + std::to_string(mesh.triangles.size()) + "\n");
  // Most readers expect int; indices above its range are still exact as uint.
  const bool fits_int = mesh.positions.size() <= std::size_t{1} << 31;
  const bool has_caps = info.cap_triangles > 0;
  out.text(std::string("property list uchar ") + (fits_int ? "int" : "uint") + " vertex_indices\n" +
           (has_caps ? "property uchar cap\n" : "") + "end_header\n");
  for (const Vec3& p : mesh.positions) {
    out.bytes(p);
  }
  const std::size_t first_cap = mesh.triangles.size() - info.cap_triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    out.bytes(std::uint8_t{3});
    out.bytes(mesh.triangles[t]);
    if (has_caps) {
      out.bytes(static_cast<std::uint8_t>(t >= first_cap ? 1 : 0));
    }
  }
  out.flush();
}

}  // namespace isoatlas::detail::io
