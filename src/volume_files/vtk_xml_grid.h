// SPDX-License-Identifier: Apache-2.0
// The pieces of a VTK XML image or rectilinear grid: all in one file, or each in its own file
// (.pvti, .pvtr).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "files/vtk_xml_header.h"

namespace isoatlas::detail::io {

/// The indices of the first and the last point along x, y and z.
struct PointExtent {
  std::array<std::int64_t, 3> first{0, 0, 0}, last{-1, -1, -1};
  friend bool operator==(const PointExtent&, const PointExtent&) = default;

  bool is_empty() const;
  bool contains(const PointExtent& other) const;
  PointExtent intersection(const PointExtent& other) const;
  std::array<std::size_t, 3> size() const;  ///< points along each axis, 0 if last is before first
};

std::string to_string(const PointExtent& extent);  ///< "0 9 0 9 0 9", as in the file

struct VtkXmlPiece {
  std::shared_ptr<const VtkXmlHeader> header;  ///< of the file that holds it
  const XmlElement* element = nullptr;         ///< its element <Piece>
  PointExtent extent;                          ///< all points of the piece
  PointExtent wanted;  ///< the points to read: a file may hold more than the .pvti states
};

struct VtkXmlGrid {
  std::shared_ptr<const VtkXmlHeader> header;
  const XmlElement* element =
      nullptr;               ///< <ImageData>, <PImageData>, <RectilinearGrid> or <PRectilinearGrid>
  bool is_parallel = false;  ///< true if the pieces are in other files
  bool is_rectilinear = false;
  PointExtent extent;
  std::vector<VtkXmlPiece> pieces;  ///< only pieces that are not empty
};

/// @throws Error(bad_file)     if a piece is missing, belongs to another grid or has an invalid
/// extent
/// @throws Error(unsupported)  if the file holds something else
VtkXmlGrid read_vtk_xml_grid(const std::filesystem::path& path);

}  // namespace isoatlas::detail::io
