// SPDX-License-Identifier: Apache-2.0
// GIfTI 1.0, the surface format of neuroimaging: an XML file with an array of points and an array
// of triangles. Each array is text, or base64 of its bytes, or base64 of its bytes compressed by
// zlib.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "files/file_error.h"
#include "files/number_text.h"
#include "files/stored_data.h"
#include "mesh_files/base64.h"
#include "mesh_files/formats.h"
#include "mesh_files/polygons.h"
#include "mesh_files/same_mesh.h"
#include "mesh_files/stored_form.h"
#include "mesh_files/xml_text.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kPoints = "NIFTI_INTENT_POINTSET";
constexpr const char* kTriangles = "NIFTI_INTENT_TRIANGLE";
constexpr const char* kSpace = "SPACE";  // 3D Slicer's name for it, as in the other formats
constexpr const char* kDescription = "Description";
constexpr const char* kUnknownSpace = "unknown";

// ----------------------------------------------------------------------------------------- writing

std::string metadata_xml(const std::vector<std::pair<const char*, std::string>>& entries) {
  std::string xml = "<MetaData>\n";
  for (const auto& [name, value] : entries) {
    if (!value.empty()) {
      xml +=
          std::string("<MD><Name>") + name + "</Name><Value>" + xml_text(value) + "</Value></MD>\n";
    }
  }
  return xml + "</MetaData>\n";
}

template <class Row>
std::string array_xml(const char* intent, const char* type, const std::vector<Row>& rows,
                      const std::string& about, const fs::path& path) {
  uLongf packed_bytes = compressBound(rows.size() * sizeof(Row));
  std::string packed(packed_bytes, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &packed_bytes,
                reinterpret_cast<const Bytef*>(rows.data()), rows.size() * sizeof(Row),
                Z_DEFAULT_COMPRESSION) != Z_OK) {
    throw bad_file(path, "cannot be written: zlib cannot compress its arrays");
  }
  packed.resize(packed_bytes);
  return std::string("<DataArray Intent=\"") + intent + "\" DataType=\"" + type +
         "\" ArrayIndexingOrder=\"RowMajorOrder\" " + "Dimensionality=\"2\" Dim0=\"" +
         std::to_string(rows.size()) + "\" Dim1=\"3\" Encoding=\"GZipBase64Binary\" " +
         "Endian=\"LittleEndian\" ExternalFileName=\"\" ExternalFileOffset=\"\">\n" + about +
         "<Data>" + to_base64(packed) + "</Data>\n</DataArray>\n";
}

std::string coordinate_system_xml(const MeshFileInfo& info) {
  const char* space = info.space == "RAS" ? "NIFTI_XFORM_SCANNER_ANAT" : "NIFTI_XFORM_UNKNOWN";
  return std::string("<CoordinateSystemTransformMatrix>\n<DataSpace>") + space +
         "</DataSpace>\n<TransformedSpace>" + space +
         "</TransformedSpace>\n<MatrixData>\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 "
         "1\n</MatrixData>\n</CoordinateSystemTransformMatrix>\n";
}

// ----------------------------------------------------------------------------------------- reading

struct ElementType {
  std::string_view name;
  std::size_t bytes;
  double (*value)(const char* bytes);
};

template <class Value>
double value_of(const char* bytes) {
  Value value{};
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

constexpr std::array kTypes{ElementType{"NIFTI_TYPE_FLOAT32", 4, value_of<float>},
                            ElementType{"NIFTI_TYPE_FLOAT64", 8, value_of<double>},
                            ElementType{"NIFTI_TYPE_UINT8", 1, value_of<std::uint8_t>},
                            ElementType{"NIFTI_TYPE_INT16", 2, value_of<std::int16_t>},
                            ElementType{"NIFTI_TYPE_INT32", 4, value_of<std::int32_t>},
                            ElementType{"NIFTI_TYPE_UINT32", 4, value_of<std::uint32_t>},
                            ElementType{"NIFTI_TYPE_INT64", 8, value_of<std::int64_t>}};

// Reads one <DataArray> of rows of three numbers.
class ArrayReader {
 public:
  ArrayReader(const pugi::xml_node& array, const std::string& name, const fs::path& path)
      : array_(array), name_(name), path_(path) {}

  std::vector<Vec3> rows() const {
    const std::uint64_t count = row_count();
    const std::string encoding = attribute("Encoding");
    const std::vector<double> values =
        encoding == "ASCII" ? numbers_in_text(3 * count) : numbers_in_bytes(3 * count, encoding);
    const bool by_rows = attribute("ArrayIndexingOrder") != "ColumnMajorOrder";
    std::vector<Vec3> result(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t first = by_rows ? 3 * i : i;
      const std::size_t step = by_rows ? 1 : count;
      result[i] = {values[first], values[first + step], values[first + 2 * step]};
    }
    return result;
  }

 private:
  std::string attribute(const char* key) const { return array_.attribute(key).value(); }

  Error error(const std::string& what) const {
    return bad_file(path_, "its array of " + name_ + " " + what);
  }

  std::uint64_t row_count() const {
    const std::string text = attribute("Dim0");
    std::uint64_t count = 0;
    if (attribute("Dimensionality") != "2" || attribute("Dim1") != "3" ||
        !parse_number(text, count)) {
      throw error("is " + one_line(attribute("Dimensionality"), 20) + "-dimensional with Dim0=\"" +
                  one_line(text, 20) + "\" and Dim1=\"" + one_line(attribute("Dim1"), 20) +
                  "\", expected rows of 3");
    }
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (count > kMost) {
      throw error("has " + text + " rows, expected at most 4294967295");
    }
    return count;
  }

  std::string_view data() const { return array_.child("Data").child_value(); }

  std::vector<double> numbers_in_text(std::uint64_t count) const {
    std::string_view text = data();
    require_possible_bytes(path_, count, text.size(), 1);
    std::vector<double> values(count);
    for (double& value : values) {
      const std::size_t first = text.find_first_not_of(" \t\r\n");
      text.remove_prefix(first == std::string_view::npos ? text.size() : first);
      const auto [end, failure] = leading_number(text, value);
      if (failure != std::errc()) {
        throw error("has '" + one_line(text.substr(0, 20)) + "', expected " +
                    std::to_string(count) + " numbers");
      }
      text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
    if (const std::size_t more = text.find_first_not_of(" \t\r\n");
        more != std::string_view::npos) {
      throw error("has '" + one_line(text.substr(more, 20)) + "' after its " +
                  std::to_string(count) + " numbers, expected no more of them");
    }
    return values;
  }

  std::vector<double> numbers_in_bytes(std::uint64_t count, const std::string& encoding) const {
    const std::string type_name = attribute("DataType");
    const auto type = std::ranges::find(kTypes, type_name, &ElementType::name);
    if (type == kTypes.end()) {
      throw error("has the type '" + one_line(type_name, 40) +
                  "', expected NIFTI_TYPE_FLOAT32 or NIFTI_TYPE_INT32");
    }
    std::string bytes = unpacked(count * type->bytes, encoding);
    const bool is_big_endian = attribute("Endian") == "BigEndian";
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) {
      char* first = bytes.data() + i * type->bytes;
      if (is_big_endian) {
        std::reverse(first, first + type->bytes);
      }
      values[i] = type->value(first);
    }
    return values;
  }

  std::string unpacked(std::uint64_t stated, const std::string& encoding) const {
    const bool is_packed = encoding == "GZipBase64Binary";
    if (!is_packed && encoding != "Base64Binary") {
      throw unsupported(path_, "keeps its array of " + name_ + " with the encoding '" +
                                   one_line(encoding, 40) +
                                   "', expected GZipBase64Binary, Base64Binary or ASCII");
    }
    std::string bytes = from_base64(data());
    if (is_packed) {
      require_possible_bytes(path_, stated, bytes.size());
      bytes = inflated(bytes, stated);
    }
    if (bytes.size() != stated) {
      throw error("is cut off or damaged: it has " + std::to_string(bytes.size()) +
                  " bytes of values, expected " + std::to_string(stated));
    }
    return bytes;
  }

  // One byte more than stated shows that there are too many.
  std::string inflated(const std::string& packed, std::uint64_t stated) const {
    std::string bytes(stated + 1, '\0');
    z_stream stream{};
    constexpr int kAnyHeader = 15 + 32;  // zlib or gzip
    if (inflateInit2(&stream, kAnyHeader) != Z_OK) {
      throw out_of_memory(path_, stated);
    }
    int status = Z_OK;
    std::size_t taken = 0;
    std::size_t given = 0;
    constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();
    while (status == Z_OK && given < bytes.size()) {
      const std::size_t in = std::min(packed.size() - taken, kMostAtOnce);
      const std::size_t out = std::min(bytes.size() - given, kMostAtOnce);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
      stream.avail_in = static_cast<uInt>(in);
      stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + given);
      stream.avail_out = static_cast<uInt>(out);
      status = inflate(&stream, Z_NO_FLUSH);
      taken += in - stream.avail_in;
      given += out - stream.avail_out;
      if (in == stream.avail_in && out == stream.avail_out && status == Z_OK) {
        status = Z_BUF_ERROR;
      }
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END) {
      throw error("is damaged or cut off: it cannot be decompressed");
    }
    bytes.resize(given);
    return bytes;
  }

  const pugi::xml_node array_;
  const std::string name_;
  const fs::path& path_;
};

pugi::xml_document parsed(std::string& xml, const fs::path& path) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer_inplace(xml.data(), xml.size());
  if (!document.child("GIFTI")) {
    throw bad_file(path, "is not a GIfTI file");
  }
  if (!result) {
    throw bad_file(path, std::string("is damaged or cut off: it is not well-formed XML: ") +
                             result.description());
  }
  return document;
}

pugi::xml_node only_array(const pugi::xml_node& gifti, const char* intent, const std::string& name,
                          const fs::path& path) {
  pugi::xml_node found;
  for (const pugi::xml_node array : gifti.children("DataArray")) {
    if (std::string_view(array.attribute("Intent").value()) != intent) {
      continue;
    }
    if (found) {
      throw unsupported(path, "has more than one array of " + name + ", expected one surface");
    }
    found = array;
  }
  if (!found) {
    throw unsupported(path, "has no array of " + name + ", expected a surface (.surf.gii)");
  }
  return found;
}

// An integer in range is kept; any other value becomes an index that no mesh has.
std::uint32_t corner(double value) {
  return value >= 0 && value < kIndexOutOfRange &&
                 value == static_cast<double>(static_cast<std::uint32_t>(value))
             ? static_cast<std::uint32_t>(value)
             : kIndexOutOfRange;
}

}  // namespace

TriangleMesh read_gii(const fs::path& path) {
  static_assert(std::endian::native == std::endian::little, "arrays are read as little endian");
  std::string xml = file_contents(path);
  const pugi::xml_document document = parsed(xml, path);
  const pugi::xml_node gifti = document.child("GIFTI");
  TriangleMesh mesh;
  mesh.positions = ArrayReader(only_array(gifti, kPoints, "points", path), "points", path).rows();
  for (const Vec3& row :
       ArrayReader(only_array(gifti, kTriangles, "triangles", path), "triangles", path).rows()) {
    mesh.triangles.push_back({corner(row.x), corner(row.y), corner(row.z)});
  }
  return mesh;
}

MeshFileInfo info_in_gii(const fs::path& path) {
  std::string xml = file_contents(path);
  const pugi::xml_document document = parsed(xml, path);
  MeshFileInfo info{
      .space = "RAS", .comment = "", .unit = LengthUnit::millimetre};  // the convention of GIfTI
  for (const pugi::xml_node entry : document.child("GIFTI").child("MetaData").children("MD")) {
    const std::string name = entry.child("Name").child_value();
    if (name == kSpace) {
      info.space = entry.child("Value").child_value();
    } else if (name == kDescription) {
      info.comment = entry.child("Value").child_value();
    }
  }
  if (info.space != "RAS") {
    info.unit = LengthUnit::unknown;
  }
  if (info.space == kUnknownSpace) {
    info.space.clear();
  }
  return info;
}

void write_gii(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  if (mesh.positions.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw bad_file(file.destination(),
                   "not written: it has more vertices than a GIfTI file can number (2147483647)");
  }
  std::vector<Float3> points;
  points.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    points.push_back(rounded(mesh.positions[v], v, file.destination()));
  }
  file.stream()
      << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n"
         "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n"
      << metadata_xml({{kDescription, info.comment},
                       {kSpace, info.space.empty() ? kUnknownSpace : info.space}})
      << "<LabelTable/>\n"
      << array_xml(
             kPoints, "NIFTI_TYPE_FLOAT32", points,
             metadata_xml({{"GeometricType", "Reconstruction"}}) + coordinate_system_xml(info),
             file.destination())
      << array_xml(
             kTriangles, "NIFTI_TYPE_INT32", mesh.triangles,
             metadata_xml({{"TopologicalType", is_closed_manifold(mesh) ? "Closed" : "Open"}}),
             file.destination())
      << "</GIFTI>\n";
}

}  // namespace isoatlas::detail::io
