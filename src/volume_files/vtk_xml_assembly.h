// SPDX-License-Identifier: Apache-2.0
// Assembles the samples of pieces. Pieces share points and may overlap further.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "files/vtk_values.h"
#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// A part of a grid of samples: `size` samples along each axis, from `first` on.
struct SampleBox {
  std::array<std::size_t, 3> first{}, size{};

  std::uint64_t count() const { return std::uint64_t{size[0]} * size[1] * size[2]; }
};

class PieceAssembly {
 public:
  /// @param samples  memory for size[0] x size[1] x size[2] samples
  PieceAssembly(const std::filesystem::path& path, const std::array<std::size_t, 3>& size,
                SampleType type, std::byte* samples);

  /// Reads all samples of a piece and keeps the wanted ones.
  ///
  /// @param stored   the box of the values
  /// @param wanted   a box within `stored` and within the volume
  /// @param is_copy  per stored sample, true if another piece has the original, which takes
  /// precedence; empty if no sample is a copy
  void add(VtkValues& values, std::uint64_t components, std::uint64_t component,
           const SampleBox& stored, const SampleBox& wanted, const std::vector<bool>& is_copy);

  /// @throws Error(bad_file) if samples are in no piece, or pieces differ by more than rounding;
  /// smaller differences give a warning in `source`
  void finish(VolumeSource& source) const;

 private:
  enum class State : std::uint8_t { missing, copied, original };

  void store(const std::array<std::size_t, 3>& at, const std::byte* sample, bool is_copy);
  std::size_t index_of(const std::array<std::size_t, 3>& at) const {
    return at[0] + size_[0] * (at[1] + size_[1] * at[2]);
  }

  std::filesystem::path path_;
  std::array<std::size_t, 3> size_;
  SampleType type_;
  std::byte* samples_;
  std::vector<State> states_;
  double largest_difference_ = 0;  // of two pieces at one sample
  std::array<std::size_t, 3> largest_difference_at_{};
};

}  // namespace isoatlas::detail::io
