// SPDX-License-Identifier: Apache-2.0
// VTK's XML image data. The samples stay in VTK's array, which the volume's owner keeps alive.
#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDataObject.h>
#include <vtkDataSetAttributes.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkXMLImageDataReader.h>

#include <string>

#include "files/file_error.h"
#include "volume_files/readers.h"
#include "volume_files/grid_of_file.h"
#include "files/library_messages.h"
#include "files/stored_data.h"
#include "files/vtk_xml_file.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

SampleType sample_type_of(int vtk_type, const fs::path& path) {
  switch (vtk_type) {
    case VTK_CHAR:
    case VTK_SIGNED_CHAR:
      return SampleType::int8;
    case VTK_UNSIGNED_CHAR:
      return SampleType::uint8;
    case VTK_SHORT:
      return SampleType::int16;
    case VTK_UNSIGNED_SHORT:
      return SampleType::uint16;
    case VTK_INT:
      return SampleType::int32;
    case VTK_UNSIGNED_INT:
      return SampleType::uint32;
    case VTK_LONG:
      return sizeof(long) == 8 ? SampleType::int64 : SampleType::int32;
    case VTK_UNSIGNED_LONG:
      return sizeof(long) == 8 ? SampleType::uint64 : SampleType::uint32;
    case VTK_ID_TYPE:
      return sizeof(vtkIdType) == 8 ? SampleType::int64 : SampleType::int32;
    case VTK_LONG_LONG:
      return SampleType::int64;
    case VTK_UNSIGNED_LONG_LONG:
      return SampleType::uint64;
    case VTK_FLOAT:
      return SampleType::float32;
    case VTK_DOUBLE:
      return SampleType::float64;
    default:
      throw unsupported(path, "has samples that are not integers of 8 to 64 bits, float or double");
  }
}

// What the header says about the array to read: the one marked as the scalars, else the only one there is.
vtkInformation& choose_array(vtkInformation& header, const fs::path& path) {
  vtkInformationVector* arrays = header.Get(vtkDataObject::POINT_DATA_VECTOR());
  const int count = arrays == nullptr ? 0 : arrays->GetNumberOfInformationObjects();
  std::string names;
  for (int i = 0; i < count; ++i) {
    vtkInformation& array = *arrays->GetInformationObject(i);
    const int active = array.Get(vtkDataObject::FIELD_ACTIVE_ATTRIBUTE());
    if (count == 1 || (active & (1 << vtkDataSetAttributes::SCALARS)) != 0) {
      return array;
    }
    const char* array_name = array.Get(vtkDataObject::FIELD_NAME());
    names += std::string(i > 0 ? ", " : "") + (array_name != nullptr ? array_name : "(unnamed)");
  }
  if (count == 0) {
    throw unsupported(path, "has no point data, expected one scalar per point (cell data is not read)");
  }
  throw unsupported(path, "has several point arrays (" + one_line(names) + ") and none is marked as the scalars");
}

}  // namespace

VolumeFile read_vti(const fs::path& path, const ReadOptions& /*options*/) {
  const LibraryMessages messages;
  const auto require_no_error = [&] {
    if (const std::string error = messages.first_vtk_error(); !error.empty()) {
      throw bad_file(path, "cannot be read: " + error);
    }
  };

  vtkNew<vtkXMLImageDataReader> reader;
  if (reader->CanReadFile(path.c_str()) == 0) {
    throw bad_file(path, "is not a VTK XML image data file");
  }
  require_readable_vtk_xml(path);
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  require_no_error();

  vtkInformation& header = *reader->GetOutputInformation(0);
  std::array<int, 6> extent{0, -1, 0, -1, 0, -1};
  header.Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
  std::array<std::size_t, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t samples = std::int64_t{extent[2 * axis + 1]} - extent[2 * axis] + 1;
    size[axis] = samples > 0 ? static_cast<std::size_t>(samples) : 0;
  }
  vtkInformation& array = choose_array(header, path);
  Volume volume;
  volume.type = sample_type_of(array.Get(vtkDataObject::FIELD_ARRAY_TYPE()), path);
  if (const int values = array.Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()); values != 1) {
    throw unsupported(path, "has " + std::to_string(values) + " values per sample (colour or vector), expected one");
  }
  const std::uint64_t bytes = checked_sample_bytes(path, size, bytes_per_sample(volume.type));
  constexpr std::uint64_t kMostBytesPerByte = 10'000;  // LZMA, the strongest of VTK's compressors, on constant data
  require_possible_bytes(path, bytes, readable_file_size(path), kMostBytesPerByte);

  // Only that array: others may be large, and arrays of strings make VTK 9.1 crash.
  if (array.Get(vtkDataObject::FIELD_NAME()) == nullptr) {
    throw unsupported(path, "its point array has no name");
  }
  const std::string array_name = array.Get(vtkDataObject::FIELD_NAME());  // Update() replaces `array`
  reader->GetCellDataArraySelection()->DisableAllArrays();
  reader->GetPointDataArraySelection()->DisableAllArrays();
  reader->GetPointDataArraySelection()->EnableArray(array_name.c_str());
  reader->Update();
  require_no_error();

  vtkImageData* image = reader->GetOutput();
  const vtkSmartPointer<vtkDataArray> samples = image->GetPointData()->GetArray(array_name.c_str());
  if (samples == nullptr || static_cast<std::uint64_t>(samples->GetNumberOfValues()) != bytes / bytes_per_sample(volume.type) ||
      sample_type_of(samples->GetDataType(), path) != volume.type) {
    throw bad_file(path, "does not hold the samples its header promises");
  }

  const std::array<double, 3> spacing{image->GetSpacing()[0], image->GetSpacing()[1], image->GetSpacing()[2]};
  std::array<double, 3> origin{image->GetOrigin()[0], image->GetOrigin()[1], image->GetOrigin()[2]};
  std::array<Vec3, 3> axes;
  const vtkMatrix3x3& matrix = *image->GetDirectionMatrix();
  for (int axis = 0; axis < 3; ++axis) {
    const auto column = static_cast<std::size_t>(axis);
    axes[column] = {matrix.GetElement(0, axis), matrix.GetElement(1, axis), matrix.GetElement(2, axis)};
    // VTK's origin belongs to index 0; our first sample is the first of the extent.
    const double offset = spacing[column] * extent[2 * column];
    origin[0] += axes[column].x * offset;
    origin[1] += axes[column].y * offset;
    origin[2] += axes[column].z * offset;
  }
  volume.grid = grid_of_file(path, size, {spacing[0], spacing[1], spacing[2]}, {origin[0], origin[1], origin[2]}, axes);
  volume.samples = samples->GetVoidPointer(0);
  volume.owner = std::shared_ptr<const void>(volume.samples, [samples](const void*) {});
  VolumeFile file{std::move(volume), {}};
  file.source.format = "VTK XML image data";
  return file;
}

}  // namespace isoatlas::io
