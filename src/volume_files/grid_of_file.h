// SPDX-License-Identifier: Apache-2.0
// What every volume reader checks before it trusts a header.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

/// A file's geometry as a Grid. A negative spacing turns its axis round and an axis that is no unit
/// vector gives its length to the spacing, so the positions of the samples in the world stay what
/// the file says.
///
/// @param axes  direction of the x, y and z axis (the columns of a direction matrix)
/// @throws Error(bad_file) if a number is not finite, a spacing is zero or the axes do not span the
/// space
Grid grid_of_file(const std::filesystem::path& path, const std::array<std::size_t, 3>& size,
                  const Vec3& spacing, const Vec3& origin, const std::array<Vec3, 3>& axes);

/// Bytes of the samples.
///
/// @throws Error(unsupported) if there are fewer than two samples along an axis
/// @throws Error(bad_file) if the product does not fit in 63 bits
std::uint64_t checked_sample_bytes(const std::filesystem::path& path,
                                   const std::array<std::size_t, 3>& size,
                                   std::size_t bytes_per_sample);

/// @throws Error(out_of_memory) if `bytes` is more than `options.max_memory`
void require_within_memory_limit(const std::filesystem::path& path, std::uint64_t bytes,
                                 const ReadOptions& options);

/// Memory for samples, not initialised, aligned for any sample type.
/// @throws Error(out_of_memory) if there is none, or `bytes` is more than `options.max_memory`
std::shared_ptr<std::byte[]> allocate_samples(const std::filesystem::path& path,
                                              std::uint64_t bytes, const ReadOptions& options);

}  // namespace isoatlas::detail::io
