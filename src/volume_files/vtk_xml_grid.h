// SPDX-License-Identifier: Apache-2.0
// The pieces of a VTK XML image or rectilinear grid: all in one file, or (.pvti, .pvtr) each in a
// file of its own.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "files/vtk_xml_header.h"

namespace isoatlas::detail::io {

/// Numbers of the first and the last point along x, y and z.
struct PointExtent {
  std::array<std::int64_t, 3> first{0, 0, 0}, last{-1, -1, -1};
  friend bool operator==(const PointExtent&, const PointExtent&) = default;

  bool is_empty() const;
  bool contains(const PointExtent& other) const;
  PointExtent intersection(const PointExtent& other) const;
  std::array<std::size_t, 3> size()
      const;  ///< points along each axis, 0 where last is before first
};

std::string to_string(const PointExtent& extent);  ///< "0 9 0 9 0 9", as in the file

struct VtkXmlPiece {
  std::shared_ptr<const VtkXmlHeader> header;  ///< of the file that it is in
  const XmlElement* element = nullptr;         ///< <Piece> there
  PointExtent extent;                          ///< all points that it holds
  PointExtent
      wanted;  ///< those that are read: a file may hold more than its header's file states
};

struct VtkXmlGrid {
  std::shared_ptr<const VtkXmlHeader> header;
  const XmlElement* element =
      nullptr;               ///< <ImageData>, <PImageData>, <RectilinearGrid> or <PRectilinearGrid>
  bool is_parallel = false;  ///< the pieces are in other files
  bool is_rectilinear = false;
  PointExtent extent;
  std::vector<VtkXmlPiece> pieces;  ///< those that are not empty
};

/// @throws Error(bad_file)     a piece is missing, is not of this grid, or has an extent that is
/// none
/// @throws Error(unsupported)  the file holds something else
VtkXmlGrid read_vtk_xml_grid(const std::filesystem::path& path);

}  // namespace isoatlas::detail::io
