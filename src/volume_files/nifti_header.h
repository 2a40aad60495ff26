// SPDX-License-Identifier: Apache-2.0
// The header of a NIfTI-1, NIfTI-2 or Analyze 7.5 file, in native byte order.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

enum class NiftiVersion : std::uint8_t { analyze, nifti1, nifti2 };

/// The fields that a volume depends on, with the names of the specification.
struct NiftiHeader {
  NiftiVersion version = NiftiVersion::analyze;
  bool swap = false;         ///< true if the file's byte order differs from the machine's
  bool is_one_file = false;  ///< the samples follow the header; otherwise they are in an .img file
  std::array<std::int64_t, 8> dim{};
  int datatype = 0;
  int bitpix = 0;
  std::array<double, 8> pixdim{};
  double vox_offset = 0;
  double scl_slope = 0, scl_inter = 0;
  int qform_code = 0, sform_code = 0;  ///< 0: not given; always 0 in Analyze
  std::array<double, 3> quatern{};     ///< b, c, d
  Vec3 qoffset{};
  std::array<std::array<double, 4>, 3> srow{};
  int xyzt_units = 0;
  int intent_code = 0;
};

/// @throws Error(bad_file)     if the header is cut off or not a NIfTI header, or states an invalid
/// number of dimensions or a size that is not positive
/// @throws Error(unsupported)  for CIFTI
NiftiHeader read_nifti_header(const std::filesystem::path& header_file);

/// The positions of the samples in millimetres and LPS. Adds the decisions about them to `source`.
/// @throws Error(bad_file) if neither an affine nor the voxel size gives a grid
Grid nifti_grid(const NiftiHeader& header, const std::filesystem::path& header_file,
                VolumeSource& source);

}  // namespace isoatlas::detail::io
