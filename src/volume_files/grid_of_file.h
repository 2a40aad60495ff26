// SPDX-License-Identifier: Apache-2.0
// Checks that every volume reader makes before it trusts a header.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// The Grid for the geometry that a file states. A negative spacing reverses its axis, and the
/// length of an axis that is not a unit vector is moved to the spacing, so the world positions of
/// the samples stay as stated.
///
/// @param axes  direction of the x, y and z axis (the columns of a direction matrix)
/// @throws Error(bad_file) if a number is not finite, a spacing is zero or the axes are linearly
/// dependent
Grid grid_of_file(const std::filesystem::path& path, const std::array<std::size_t, 3>& size,
                  const Vec3& spacing, const Vec3& origin, const std::array<Vec3, 3>& axes);

/// The size of the samples in bytes.
///
/// @throws Error(unsupported) if there are fewer than two samples along an axis
/// @throws Error(bad_file) if the product does not fit in 63 bits
std::uint64_t checked_sample_bytes(const std::filesystem::path& path,
                                   const std::array<std::size_t, 3>& size,
                                   std::size_t bytes_per_sample);

/// @throws Error(out_of_memory) if `bytes` is more than `options.max_memory`
void require_within_memory_limit(const std::filesystem::path& path, std::uint64_t bytes,
                                 const ReadOptions& options);

/// The samples of a file as they are stored, mapped into memory; see ReadOptions::map_samples.
/// @return null if the options do not request it, or if the first sample is not aligned
std::shared_ptr<std::byte[]> mapped_samples(const std::filesystem::path& path, std::uint64_t offset,
                                            std::uint64_t bytes, std::size_t bytes_per_sample,
                                            const ReadOptions& options);

/// Allocates memory for samples, not initialised, aligned for any sample type; in a temporary file
/// with ReadOptions::map_samples.
/// @throws Error(out_of_memory) if there is not enough, or `bytes` is more than
/// `options.max_memory`
std::shared_ptr<std::byte[]> allocate_samples(const std::filesystem::path& path,
                                              std::uint64_t bytes, const ReadOptions& options);

}  // namespace isoatlas::detail::io
