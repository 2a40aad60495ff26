// SPDX-License-Identifier: Apache-2.0
// Writes VTK's XML poly data as VTK's own writer does: arrays behind the text, as bytes compressed
// by zlib.
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <new>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "mesh_files/formats.h"

namespace isoatlas::detail::io {

namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::size_t kBlockBytes = 1 << 15;  // compressed at a time, as by VTK
constexpr int kZlibLevel = 5;                 // VTK's default

void append_number(std::string& bytes, std::uint64_t number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// The bytes of one array in the file: how many blocks, their size, the size of the last one if it
/// is smaller (else 0), their compressed sizes, and the compressed blocks.
std::string compressed(const char* bytes, std::size_t size) {
  const std::size_t blocks = (size + kBlockBytes - 1) / kBlockBytes;
  std::string result, packed;
  append_number(result, blocks);
  append_number(result, kBlockBytes);
  append_number(result, size % kBlockBytes);
  std::vector<char> buffer(compressBound(kBlockBytes));
  for (std::size_t begin = 0; begin < size; begin += kBlockBytes) {
    uLongf packed_size = buffer.size();
    const int status = compress2(reinterpret_cast<Bytef*>(buffer.data()), &packed_size,
                                 reinterpret_cast<const Bytef*>(bytes + begin),
                                 std::min(kBlockBytes, size - begin), kZlibLevel);
    if (status != Z_OK) throw std::bad_alloc();  // the buffer is large enough, so it is the memory
    append_number(result, packed_size);
    packed.append(buffer.data(), packed_size);
  }
  return result + packed;
}

/// The arrays behind the text of the file.
class AppendedArrays {
 public:
  /// Adds an array. @return the attributes that refer to it
  template <class T>
  std::string add(const T* values, std::size_t count) {
    const std::string attributes =
        " format=\"appended\" offset=\"" + std::to_string(size_) + "\"/>\n";
    arrays_.push_back(compressed(reinterpret_cast<const char*>(values), count * sizeof(T)));
    size_ += arrays_.back().size();
    return attributes;
  }

  void write(std::ostream& out) const {
    for (const std::string& array : arrays_)
      out.write(array.data(), static_cast<std::streamsize>(array.size()));
  }

 private:
  std::vector<std::string> arrays_;
  std::uint64_t size_ = 0;
};

std::string field_elements(const std::map<std::string, std::string>& fields,
                           AppendedArrays& arrays) {
  std::string text;
  for (const auto& [name, value] : fields) {
    if (value.empty()) continue;
    text += "      <Array type=\"String\" Name=\"" + name + "\" NumberOfTuples=\"1\"" +
            arrays.add(value.c_str(), std::strlen(value.c_str()) + 1);
  }
  return text;
}

std::string cap_element(std::size_t triangles, std::size_t cap_triangles, AppendedArrays& arrays) {
  if (cap_triangles == 0) return "";
  std::vector<std::uint8_t> is_cap(triangles, 0);
  std::fill(is_cap.end() - static_cast<std::ptrdiff_t>(cap_triangles), is_cap.end(), 1);
  return "        <DataArray type=\"UInt8\" Name=\"cap\"" +
         arrays.add(is_cap.data(), is_cap.size());
}

std::string polygon_elements(const std::vector<Triangle>& triangles, AppendedArrays& arrays) {
  std::vector<std::int64_t> numbers;
  numbers.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles)
    numbers.insert(numbers.end(), triangle.begin(), triangle.end());
  std::string text = "        <DataArray type=\"Int64\" Name=\"connectivity\"" +
                     arrays.add(numbers.data(), numbers.size());
  numbers.resize(triangles.size());  // from here on, the end of each triangle
  for (std::size_t t = 0; t < numbers.size(); ++t)
    numbers[t] = static_cast<std::int64_t>(3 * t + 3);
  text += "        <DataArray type=\"Int64\" Name=\"offsets\"" +
          arrays.add(numbers.data(), numbers.size());
  return text;
}

}  // namespace

void write_vtp(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  write_vtp(mesh, {{"SPACE", info.space}, {"COMMENT", info.comment}}, {}, info.cap_triangles,
            file);  // SPACE is 3D Slicer's name for it
}

void write_vtp(const TriangleMesh& mesh, const std::map<std::string, std::string>& fields,
               const std::vector<float>& distance, std::size_t cap_triangles, AtomicFile& file) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  AppendedArrays arrays;
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
      "  <PolyData>\n    <FieldData>\n" +
      field_elements(fields, arrays) + "    </FieldData>\n    <Piece NumberOfPoints=\"" +
      std::to_string(mesh.positions.size()) +
      "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
      std::to_string(mesh.triangles.size()) + "\">\n      <PointData>\n";
  if (!distance.empty())
    text += "        <DataArray type=\"Float32\" Name=\"" + std::string(kVtpDistance) + "\"" +
            arrays.add(distance.data(), distance.size());
  text += "      </PointData>\n      <CellData>\n" +
          cap_element(mesh.triangles.size(), cap_triangles, arrays) +
          "      </CellData>\n      <Points>\n"
          "        <DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"" +
          arrays.add(mesh.positions.data(), mesh.positions.size()) + "      </Points>\n";
  text += "      <Polys>\n" + polygon_elements(mesh.triangles, arrays) + "      </Polys>\n";
  file.stream() << text << "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _";
  arrays.write(file.stream());
  file.stream() << "\n  </AppendedData>\n</VTKFile>\n";
  file.flush();  // a full disk must be noticed before the first level of several is committed
}

}  // namespace isoatlas::detail::io
