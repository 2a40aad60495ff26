// SPDX-License-Identifier: Apache-2.0
// What formats with rules about axes and units make of a mesh.
#pragma once

#include <string>
#include <vector>

#include "isoatlas/mesh_file.h"

namespace isoatlas::detail::io {

/// A mesh as a file of some format keeps it.
struct StoredForm {
  TriangleMesh mesh;
  MeshFileInfo info;               ///< of the stored coordinates
  std::vector<std::string> notes;  ///< for people: what was changed, or what the format says that
                                   ///< nobody said; one line each
};

/// A length in one unit as a length in another; the same if either is unknown.
double convert_length(double length, LengthUnit from, LengthUnit to);

/// 3MF states a unit, and knows the micrometre, millimetre, centimetre, metre and inch. Smaller
/// units become micrometres; a mesh without a unit is stated in millimetres, unchanged.
StoredForm form_in_3mf(const TriangleMesh& mesh, const MeshFileInfo& info);

/// GIfTI has the axes of the scanner, RAS, and millimetres. A mesh in LPS becomes RAS, a known unit
/// millimetres. Sample indices and coordinates of an unknown space stay as they are.
StoredForm form_in_gifti(const TriangleMesh& mesh, const MeshFileInfo& info);

/// Is the mesh a consistently oriented manifold without a boundary?
bool is_closed_manifold(const TriangleMesh& mesh);

}  // namespace isoatlas::detail::io
