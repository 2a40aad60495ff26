// SPDX-License-Identifier: Apache-2.0
// Legacy VTK, read without a library: ITK takes cell data for point data and does not detect
// missing samples, and VTK returns uninitialised memory for them.
#include <string>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/legacy_vtk_header.h"
#include "volume_files/readers.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

std::vector<VtkArray> descriptions(const LegacyVtkHeader& header) {
  std::vector<VtkArray> arrays;
  for (const LegacyVtkArray& array : header.arrays) {
    arrays.push_back(array.array);
  }
  return arrays;
}

void require_tuples(const fs::path& path, const LegacyVtkArray& array, std::uint64_t samples) {
  if (array.tuples != samples) {
    throw bad_file(path, "its array '" + one_line(array.array.name, 80) + "' has " +
                             std::to_string(array.tuples) + " values, expected one for each of " +
                             std::to_string(samples) + " samples");
  }
}

}  // namespace

VolumeFile read_legacy_vtk(const fs::path& path, const ReadOptions& options) {
  if (packing_of(path) != Packing::none) {
    throw unsupported(path,
                      "is a compressed legacy VTK file, expected one that is decompressed first");
  }
  const LegacyVtkHeader header = read_legacy_vtk_header(path);
  VolumeFile file;
  VolumeSource& source = file.source;
  source.format = "legacy VTK";
  source.reader = "isoatlas";
  source.has_spacing = header.has_spacing;
  if (header.ignored_bytes > 0) {
    source.warnings.push_back("has " + std::to_string(header.ignored_bytes) +
                              " bytes more than its header states; they are not read");
  }
  const LegacyVtkArray& array =
      header.arrays[choose_array(path, descriptions(header), options, source)];
  const std::uint64_t component = choose_component(path, array.array, options, source);

  Volume& volume = file.volume;
  volume.view.grid = sample_grid(path, header.grid, array.array.is_cell_data, source);
  volume.view.type = array.array.type.sample;
  const std::uint64_t bytes =
      checked_sample_bytes(path, volume.view.grid.size, bytes_per_sample(volume.view.type));
  require_tuples(path, array, volume.view.grid.sample_count());
  const std::shared_ptr<std::byte[]> samples = allocate_samples(path, bytes, options);
  read_component(*open_values(path, header.is_text, array), volume.view.type,
                 array.array.components, component, array.tuples, samples.get());
  volume.view.samples = samples.get();
  volume.owner = samples;
  return file;
}

}  // namespace isoatlas::detail::io
