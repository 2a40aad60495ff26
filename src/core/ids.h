// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail {

// 32-bit ids are used everywhere after parsing; their names state which array an id addresses.
// `cell` and `CellId` always mean a Voronoi cell (or another region of a partition); a cell of
// eight samples is called grid cell. Exception: src/field and src/isosurface know no partitions; a
// cell there is a grid cell.
using CVertexId = std::uint32_t;  ///< c-vertex of a surface complex
using FaceId = std::uint32_t;     ///< face of a surface complex
using CellId =
    std::uint32_t;  ///< Voronoi cell (region) of a partition of a surface complex's c-vertices
using ComponentId = std::uint32_t;  ///< connected component

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Returns a count that must fit a 32-bit id. @throws Error(unsupported)
inline std::uint32_t checked_id(std::size_t n, const char* what) {
  if (n >= kNone) {
    throw Error(ErrorCode::unsupported,
                std::string(what) + ": " + std::to_string(n) + " do not fit 32-bit ids");
  }
  return static_cast<std::uint32_t>(n);
}

}  // namespace isoatlas::detail
