// SPDX-License-Identifier: Apache-2.0
// A mesh as a page of `isoatlas view` receives it.
#pragma once

#include <cstddef>
#include <string>

#include "isoatlas/extract.h"

namespace isoatlas::detail::tool {

/// Facts about a mesh that the page shows.
struct ShownMesh {
  double isovalue = 0;
  std::size_t reduction = 1;  ///< number of samples along an axis that were made one
  double seconds = 0;         ///< time to make it
  LengthUnit unit = LengthUnit::unknown;
};

/// uint32 L, L bytes of JSON, then per vertex 3 float32 relative to `centre` of the JSON, and per
/// triangle 3 uint32, all little-endian. 4 + L is a multiple of 4.
std::string mesh_bytes(const Extraction& extraction, const ShownMesh& shown);

}  // namespace isoatlas::detail::tool
