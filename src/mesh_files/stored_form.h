// SPDX-License-Identifier: Apache-2.0
// Converts meshes for formats that prescribe axes and units.
#pragma once

#include <string>
#include <vector>

#include "isoatlas/mesh_file.h"

namespace isoatlas::detail::io {

/// A mesh in the coordinates of a format.
struct StoredForm {
  TriangleMesh mesh;
  MeshFileInfo info;               ///< of the stored coordinates
  std::vector<std::string> notes;  ///< for the user, one line each: what was changed, or
                                   ///< what the format states that the input does not
};

/// Converts a length from one unit to another; unchanged if either is unknown.
double convert_length(double length, LengthUnit from, LengthUnit to);

/// A 3MF file states a unit: micrometre, millimetre, centimetre, metre or inch. Smaller units are
/// converted to micrometres; a mesh without a unit is stated as millimetres, unchanged.
StoredForm form_in_3mf(const TriangleMesh& mesh, const MeshFileInfo& info);

/// Programs for printing read an STL file as millimetres. A known unit is converted to them.
StoredForm form_in_stl(const TriangleMesh& mesh, const MeshFileInfo& info);

/// A GIfTI file has the axes of the scanner, RAS, and millimetres. A mesh in LPS is converted to
/// RAS, a known unit to millimetres. Sample indices and coordinates of an unknown space stay
/// unchanged.
StoredForm form_in_gifti(const TriangleMesh& mesh, const MeshFileInfo& info);

/// True if the mesh is a consistently oriented manifold without a boundary.
bool is_closed_manifold(const TriangleMesh& mesh);

}  // namespace isoatlas::detail::io
