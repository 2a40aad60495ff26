// SPDX-License-Identifier: Apache-2.0
// NRRD with raw samples: header lines, an empty line, the samples in native byte order.
//
// Based on:
//   [nrrd]  Definition of NRRD file format (teem.sourceforge.net/nrrd/format.html), version 5.
#include <array>
#include <bit>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>

#include "field/dense_volume.h"
#include "files/atomic_file.h"
#include "isoatlas/volume_file.h"

namespace isoatlas {
using namespace detail;
namespace {

std::string_view nrrd_name(SampleType type) {
  switch (type) {
    case SampleType::float32:
      return "float";
    case SampleType::float64:
      return "double";
    default:
      return name(type);
  }
}

// With the fewest digits that give the same number, in any locale.
std::string exact_digits(double number) {
  std::array<char, 32> text{};
  char* const end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return std::string(text.data(), end);
}

std::string nrrd_vector(Vec3 v) {
  return "(" + exact_digits(v.x) + "," + exact_digits(v.y) + "," + exact_digits(v.z) + ")";
}

}  // namespace

void write_nrrd(const VolumeView& volume, const std::filesystem::path& path) {
  const Volume dense = dense_volume(volume);
  const Grid& grid = volume.grid;
  std::string header = "NRRD0005\ntype: " + std::string(nrrd_name(volume.type)) +
                       "\ndimension: 3\nspace: left-posterior-superior\nsizes:";
  for (const std::size_t n : grid.size) header += " " + std::to_string(n);
  header += "\nspace directions:";
  const std::array<double, 3> spacing{grid.spacing.x, grid.spacing.y, grid.spacing.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3& d = grid.direction[a];
    header += " " + nrrd_vector({spacing[a] * d.x, spacing[a] * d.y, spacing[a] * d.z});
  }
  header += "\nspace origin: " + nrrd_vector(grid.origin);
  if (grid.unit != LengthUnit::unknown) {
    const std::string unit = " \"" + std::string(symbol(grid.unit)) + "\"";
    header += "\nspace units:" + unit + unit + unit;
  }
  if (bytes_per_sample(volume.type) > 1)
    header += std::endian::native == std::endian::little ? "\nendian: little" : "\nendian: big";
  header += "\nencoding: raw\n\n";

  io::AtomicFile file(path);
  file.stream() << header;
  file.stream().write(
      static_cast<const char*>(dense.view.samples),
      static_cast<std::streamsize>(grid.sample_count() * bytes_per_sample(volume.type)));
  file.commit();
}

}  // namespace isoatlas
