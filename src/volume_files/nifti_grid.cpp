// SPDX-License-Identifier: Apache-2.0
// The positions of NIfTI samples. A header can state them in three ways: an affine matrix (sform),
// a rotation and a voxel size (qform), or the voxel size alone. The sform is preferred, as in
// nibabel, FSL, SPM and MRtrix.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "core/vector_math.h"
#include "files/file_error.h"
#include "volume_files/grid_of_file.h"
#include "volume_files/nifti_header.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// If a length of the sform and a voxel size differ by less than this fraction, they are the same
// rounded number, and the size stays as written.
constexpr double kRounding = 1e-5;

// Positions of a sample that differ by at most this, in voxels, are equal.
constexpr double kSamePosition = 1e-4;

// sform and qform disagree if positions of a sample differ by more than this, in voxels. A
// quaternion in single precision near a half turn can be off by as much over 300 voxels.
constexpr double kDisagreement = 0.1;

constexpr int kScannerCode = 1;  // NIFTI_XFORM_SCANNER_ANAT

// How much longer than 1 a quaternion may be by rounding to single precision, with a wide margin.
constexpr double kLongestQuaternionExcess = 1e-3;

/// Maps sample indices to the file's right-anterior-superior world, in its unit.
struct Affine {
  std::array<Vec3, 3> axes{};  ///< steps from sample to sample along x, y and z
  Vec3 origin{};
};

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", value);
  return text.data();
}

std::string triple(const std::array<double, 3>& v) {
  return number(v[0]) + " x " + number(v[1]) + " x " + number(v[2]);
}

std::array<double, 3> lengths(const Affine& affine) {
  return {length(affine.axes[0]), length(affine.axes[1]), length(affine.axes[2])};
}

bool is_usable(const Affine& affine) {
  constexpr double kSmallestVolume = 1e-4;  // determinant of unit vectors
  const std::array steps = lengths(affine);
  const Vec3& o = affine.origin;
  for (const double value : {steps[0], steps[1], steps[2], o.x, o.y, o.z}) {
    if (!std::isfinite(value)) return false;
  }
  const double volume = dot(affine.axes[0], cross(affine.axes[1], affine.axes[2]));
  return std::abs(volume) > kSmallestVolume * steps[0] * steps[1] * steps[2];
}

std::array<double, 3> voxel_size(const NiftiHeader& header) {
  return {std::abs(header.pixdim[1]), std::abs(header.pixdim[2]), std::abs(header.pixdim[3])};
}

Affine sform_of(const NiftiHeader& header) {
  const auto column = [&](std::size_t i) {
    return Vec3{header.srow[0][i], header.srow[1][i], header.srow[2][i]};
  };
  return {{column(0), column(1), column(2)}, column(3)};
}

// Rotation by the unit quaternion (a, b, c, d) with a >= 0; then pixdim[0] may reverse the z axis.
Affine qform_of(const NiftiHeader& header) {
  constexpr double kHalfTurn = 1e-7;  // below this, a is 0 apart from rounding
  auto [b, c, d] = header.quatern;
  double a = 1 - (b * b + c * c + d * d);
  if (a < kHalfTurn) {
    const double scale = 1 / std::sqrt(b * b + c * c + d * d);
    b *= scale;
    c *= scale;
    d *= scale;
    a = 0;
  } else {
    a = std::sqrt(a);
  }
  auto [x, y, z] = voxel_size(header);
  if (header.pixdim[0] < 0) z = -z;
  Affine affine{
      {Vec3{(a * a + b * b - c * c - d * d) * x, 2 * (b * c + a * d) * x, 2 * (b * d - a * c) * x},
       Vec3{2 * (b * c - a * d) * y, (a * a + c * c - b * b - d * d) * y, 2 * (c * d + a * b) * y},
       Vec3{2 * (b * d + a * c) * z, 2 * (c * d - a * b) * z, (a * a + d * d - c * c - b * b) * z}},
      header.qoffset};
  if (header.version == NiftiVersion::nifti1) {  // single precision, as in the header and in the
                                                 // library of the format
    for (Vec3& axis : affine.axes) {
      axis = {static_cast<float>(axis.x), static_cast<float>(axis.y), static_cast<float>(axis.z)};
    }
  }
  return affine;
}

// The voxel size alone does not define left and right, front and back: the axes are taken as those
// of the LPS world.
Affine scaling_of(const NiftiHeader& header) {
  const auto [x, y, z] = voxel_size(header);
  return {{Vec3{-x, 0, 0}, Vec3{0, -y, 0}, Vec3{0, 0, z}}, {}};
}

/// The largest distance, over all samples, between the positions that two affines give a sample.
double largest_distance(const Affine& first, const Affine& second,
                        const std::array<std::int64_t, 8>& dim) {
  double largest = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 difference = first.origin - second.origin;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double index = (corner >> axis & 1U) != 0 ? static_cast<double>(dim[axis + 1] - 1) : 0;
      difference = difference + index * (first.axes[axis] - second.axes[axis]);
    }
    largest = std::max(largest, length(difference));
  }
  return largest;
}

/// The qform if it can be used.
std::optional<Affine> stated_qform(const NiftiHeader& header) {
  const Affine qform = qform_of(header);
  return header.qform_code > 0 && is_usable(qform) ? std::optional(qform) : std::nullopt;
}

/// The largest difference between two affines, in voxels of the first.
double disagreement(const Affine& first, const Affine& second, const NiftiHeader& header) {
  return largest_distance(first, second, header.dim) / std::ranges::min(lengths(first));
}

void warn_of_voxel_size(const NiftiHeader& header, const Affine& sform, VolumeSource& source) {
  const std::array steps = lengths(sform), size = voxel_size(header);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double distance =
        static_cast<double>(header.dim[axis + 1] - 1) * std::abs(steps[axis] - size[axis]);
    if (!(distance <= kDisagreement * steps[axis])) {  // true for NaN
      source.warnings.push_back("its voxel size is " + triple(size) + " by pixdim and " +
                                triple(steps) + " by the sform; the sform is used");
      return;
    }
  }
}

Affine sform_or_its_equal(const NiftiHeader& header, const Affine& sform, VolumeSource& source) {
  const std::optional<Affine> qform = stated_qform(header);
  const double distance = qform ? disagreement(sform, *qform, header) : 0;
  // If both are the same, the qform has perpendicular axes, unless the sform is the scanner's own,
  // which was rounded less.
  if (qform && distance <= kSamePosition && header.sform_code != kScannerCode) {
    source.decisions.push_back({"affine", "qform, which equals the sform"});
    return *qform;
  }
  source.decisions.push_back({"affine", "sform"});
  if (!qform) warn_of_voxel_size(header, sform, source);
  if (distance > kDisagreement) {
    source.warnings.push_back("its sform and its qform place samples up to " + number(distance) +
                              " voxels apart; the sform is used");
  }
  return sform;
}

void require_voxel_size(const NiftiHeader& header, const fs::path& file, VolumeSource& source) {
  for (std::size_t axis = 1; axis <= 3; ++axis) {
    const double spacing = header.pixdim[axis];
    if (!std::isfinite(spacing) || spacing == 0) {
      throw bad_file(file, "the spacing along axis " + std::to_string(axis) + " is " +
                               number(spacing) + ", expected a positive length");
    }
    if (spacing < 0) {
      source.warnings.push_back("its spacing along axis " + std::to_string(axis) + " is " +
                                number(spacing) + "; " + number(-spacing) + " is used");
    }
  }
}

Affine chosen_affine(const NiftiHeader& header, const fs::path& file, VolumeSource& source) {
  const auto decide = [&](const char* affine) { source.decisions.push_back({"affine", affine}); };
  if (header.sform_code > 0) {
    const Affine sform = sform_of(header);
    if (is_usable(sform)) return sform_or_its_equal(header, sform, source);
    if (header.qform_code <= 0)
      throw bad_file(file, "its sform is singular or not finite, expected three independent axes");
    source.warnings.push_back("its sform is singular or not finite; the qform is used");
  }
  require_voxel_size(header, file, source);
  if (header.qform_code > 0) {
    const Affine qform = qform_of(header);
    if (!is_usable(qform))
      throw bad_file(file, "its qform is not finite, expected a rotation and an origin");
    const auto [b, c, d] = header.quatern;
    if (const double norm = std::hypot(b, c, d); norm > 1 + kLongestQuaternionExcess) {
      source.warnings.push_back("the quaternion of its qform has length " + number(norm) +
                                ", expected at most 1; it is shortened to 1");
    }
    decide("qform");
    return qform;
  }
  decide("voxel size only");
  source.warnings.push_back(
      "states no orientation: its axes are assumed to point left, posterior and superior");
  return scaling_of(header);
}

double millimetres_per_unit(const NiftiHeader& header, VolumeSource& source) {
  const auto decide = [&](const std::string& unit) { source.decisions.push_back({"unit", unit}); };
  constexpr int kSpaceBits = 7;
  switch (const int code = header.xyzt_units & kSpaceBits) {
    case 1:
      decide("metre, converted to millimetre");
      return 1e3;
    case 2:
      decide("millimetre");
      return 1;
    case 3:
      decide("micrometre, converted to millimetre");
      return 1e-3;
    default:
      decide("millimetre, not stated");
      if (code != 0)
        source.warnings.push_back("has an unknown unit of length (code " + std::to_string(code) +
                                  "); millimetre is assumed");
      return 1;
  }
}

}  // namespace

Grid nifti_grid(const NiftiHeader& header, const fs::path& header_file, VolumeSource& source) {
  const Affine affine = chosen_affine(header, header_file, source);
  const std::array steps = lengths(affine), written = voxel_size(header);
  std::array<double, 3> spacing{};
  std::array<Vec3, 3> direction{};
  const double scale = millimetres_per_unit(header, source);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_as_written = std::abs(steps[axis] - written[axis]) <= kRounding * written[axis];
    spacing[axis] = (is_as_written ? written[axis] : steps[axis]) * scale;
    const Vec3& step = affine.axes[axis];
    direction[axis] = {-step.x / steps[axis], -step.y / steps[axis], step.z / steps[axis]};
  }
  const Vec3 origin{-affine.origin.x * scale, -affine.origin.y * scale, affine.origin.z * scale};
  const std::array<std::size_t, 3> size{static_cast<std::size_t>(header.dim[1]),
                                        static_cast<std::size_t>(header.dim[2]),
                                        static_cast<std::size_t>(header.dim[3])};
  Grid grid =
      grid_of_file(header_file, size, {spacing[0], spacing[1], spacing[2]}, origin, direction);
  grid.unit = LengthUnit::millimetre;
  return grid;
}

}  // namespace isoatlas::detail::io
