// SPDX-License-Identifier: Apache-2.0
// VTK's XML image data. The samples stay in VTK's array, which the volume's owner keeps alive.
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkXMLImageDataReader.h>

#include <string>

#include "io/file_error.h"
#include "io/formats.h"
#include "io/grid_of_file.h"
#include "io/library_messages.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

SampleType sample_type_of(const vtkDataArray& samples, const fs::path& path) {
  switch (const_cast<vtkDataArray&>(samples).GetDataType()) {
    case VTK_CHAR:
    case VTK_SIGNED_CHAR: return SampleType::int8;
    case VTK_UNSIGNED_CHAR: return SampleType::uint8;
    case VTK_SHORT: return SampleType::int16;
    case VTK_UNSIGNED_SHORT: return SampleType::uint16;
    case VTK_INT: return SampleType::int32;
    case VTK_UNSIGNED_INT: return SampleType::uint32;
    case VTK_LONG: return sizeof(long) == 8 ? SampleType::int64 : SampleType::int32;
    case VTK_UNSIGNED_LONG: return sizeof(long) == 8 ? SampleType::uint64 : SampleType::uint32;
    case VTK_ID_TYPE: return sizeof(vtkIdType) == 8 ? SampleType::int64 : SampleType::int32;
    case VTK_LONG_LONG: return SampleType::int64;
    case VTK_UNSIGNED_LONG_LONG: return SampleType::uint64;
    case VTK_FLOAT: return SampleType::float32;
    case VTK_DOUBLE: return SampleType::float64;
    default:
      throw unsupported(path, "has samples of a type that is not an integer of 8 to 64 bits, float or double");
  }
}

// The array marked as the scalars, else the only array there is.
vtkDataArray* choose_samples(vtkPointData& arrays, const fs::path& path) {
  if (vtkDataArray* scalars = arrays.GetScalars()) {
    return scalars;
  }
  if (arrays.GetNumberOfArrays() == 1 && arrays.GetArray(0) != nullptr) {
    return arrays.GetArray(0);
  }
  if (arrays.GetNumberOfArrays() == 0) {
    throw unsupported(path, "has no point data, expected one scalar per point (cell data is not read)");
  }
  std::string names;
  for (int i = 0; i < arrays.GetNumberOfArrays(); ++i) {
    names += std::string(i > 0 ? ", " : "") + (arrays.GetArrayName(i) != nullptr ? arrays.GetArrayName(i) : "(unnamed)");
  }
  throw unsupported(path, "has several point arrays (" + names + ") and none is marked as the scalars");
}

// The smallest file that could hold `samples`: compressors VTK knows shrink constant data no further than this.
// Keeps an absurd extent from being allocated before anything is read.
constexpr std::uint64_t kMostSamplesPerByte = 10'000;

}  // namespace

Volume read_vti(const fs::path& path) {
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
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  require_no_error();
  std::array<int, 6> extent{0, -1, 0, -1, 0, -1};
  reader->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
  std::array<std::size_t, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t samples = std::int64_t{extent[2 * axis + 1]} - extent[2 * axis] + 1;
    size[axis] = samples > 0 ? static_cast<std::size_t>(samples) : 0;
  }
  const std::uint64_t least_bytes = checked_sample_bytes(path, size, 1);
  if (least_bytes / kMostSamplesPerByte > readable_file_size(path)) {
    throw bad_file(path, "the header promises " + std::to_string(least_bytes) + " samples, the file is too short for them");
  }
  reader->Update();
  require_no_error();

  vtkImageData* image = reader->GetOutput();
  const vtkSmartPointer<vtkDataArray> samples = choose_samples(*image->GetPointData(), path);
  if (samples->GetNumberOfComponents() != 1) {
    throw unsupported(path, "has " + std::to_string(samples->GetNumberOfComponents()) +
                                " values per sample (colour or vector), expected one");
  }
  Volume volume;
  volume.type = sample_type_of(*samples, path);
  checked_sample_bytes(path, size, bytes_per_sample(volume.type));
  if (static_cast<std::uint64_t>(samples->GetNumberOfTuples()) != least_bytes) {
    throw bad_file(path, "has " + std::to_string(samples->GetNumberOfTuples()) + " samples, the header promises " +
                             std::to_string(least_bytes));
  }

  const std::array<double, 3> spacing{image->GetSpacing()[0], image->GetSpacing()[1], image->GetSpacing()[2]};
  std::array<Vec3, 3> axes;
  std::array<double, 3> origin{image->GetOrigin()[0], image->GetOrigin()[1], image->GetOrigin()[2]};
  for (int axis = 0; axis < 3; ++axis) {
    const vtkMatrix3x3& matrix = *image->GetDirectionMatrix();
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
  return volume;
}

}  // namespace isoatlas::io
