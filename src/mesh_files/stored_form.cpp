// SPDX-License-Identifier: Apache-2.0
#include "mesh_files/stored_form.h"

#include <algorithm>
#include <cmath>

#include "core/file_name.h"

namespace isoatlas {
using namespace detail;

namespace {

bool is_voxel_space(const MeshFileInfo& info) { return lower_case(info.space) == "voxel"; }

/// Converts a known unit.
/// @param format  with its article: "a .gii"
void convert_to_millimetres(io::StoredForm& form, const std::string& format) {
  const LengthUnit unit = form.info.unit;
  if (unit == LengthUnit::unknown || unit == LengthUnit::millimetre) return;
  form.info.unit = LengthUnit::millimetre;
  convert_unit(form.mesh, unit, form.info.unit);
  form.notes.push_back("the coordinates of " + format + " are in millimetres");
}

/// The number of smaller units in one larger unit; exactly an integer if it is one apart from
/// rounding.
double ratio(LengthUnit larger, LengthUnit smaller) {
  constexpr double kRounding = 1e-12;
  const double quotient = metres(larger) / metres(smaller);
  const double whole = std::round(quotient);
  return std::fabs(quotient - whole) <= kRounding * whole ? whole : quotient;
}

}  // namespace

void convert_unit(TriangleMesh& mesh, LengthUnit from, LengthUnit to) {
  for (Vec3& p : mesh.positions) {
    p = {io::convert_length(p.x, from, to), io::convert_length(p.y, from, to),
         io::convert_length(p.z, from, to)};
  }
}

}  // namespace isoatlas

namespace isoatlas::detail::io {

// Divides by integers: multiplying by fractions such as 0.001, which are not exact in binary, would
// round twice.
double convert_length(double length, LengthUnit from, LengthUnit to) {
  if (from == to || from == LengthUnit::unknown || to == LengthUnit::unknown) {
    return length;
  }
  return metres(from) > metres(to) ? length * ratio(from, to) : length / ratio(to, from);
}

bool is_closed_manifold(const TriangleMesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  return topology.is_manifold() && topology.is_oriented() && topology.boundary_edges == 0 &&
         topology.triangles > 0;
}

StoredForm form_in_3mf(const TriangleMesh& mesh, const MeshFileInfo& info) {
  StoredForm form{mesh, info, {}};
  if (info.unit == LengthUnit::unknown) {
    form.info.unit = LengthUnit::millimetre;
    form.notes.push_back(is_voxel_space(info)
                             ? "a .3mf states a unit: its sample indices are read as millimetres"
                             : "a .3mf states a unit: millimetres, as the volume states none");
  } else if (info.unit == LengthUnit::angstrom || info.unit == LengthUnit::nanometre) {
    form.info.unit = LengthUnit::micrometre;
    convert_unit(form.mesh, info.unit, form.info.unit);
    form.notes.push_back(
        "a .3mf has no unit smaller than the micrometre: its coordinates are in micrometres");
  }
  if (!is_closed_manifold(mesh)) {
    form.notes.push_back(
        "the mesh is open: it is a surface in the .3mf, which programs for printing may leave out");
  }
  return form;
}

StoredForm form_in_stl(const TriangleMesh& mesh, const MeshFileInfo& info) {
  StoredForm form{mesh, info, {}};
  if (info.unit == LengthUnit::unknown) {
    form.notes.push_back(is_voxel_space(info)
                             ? "programs for printing read the sample indices of an .stl as "
                               "millimetres"
                             : "programs for printing read an .stl as millimetres: the volume "
                               "states no unit");
  }
  convert_to_millimetres(form, "an .stl");
  return form;
}

StoredForm form_in_gifti(const TriangleMesh& mesh, const MeshFileInfo& info) {
  StoredForm form{mesh, info, {}};
  const std::string space = lower_case(info.space);
  if (space != "lps" && space != "ras") {
    form.notes.push_back(
        "a .gii is expected in RAS: its coordinates are " +
        std::string(space == "voxel" ? "sample indices" : "as given, of an unknown space"));
    return form;
  }
  form.info.space = "RAS";
  if (space == "lps") {
    for (Vec3& p : form.mesh.positions) {
      p = {-p.x, -p.y, p.z};
    }
    form.notes.push_back("the coordinates of a .gii are in RAS: x and y are those of LPS negated");
  }
  if (info.unit == LengthUnit::unknown) {
    form.info.unit = LengthUnit::millimetre;
    form.notes.push_back("a .gii is read as millimetres: the volume states no unit");
  }
  convert_to_millimetres(form, "a .gii");
  return form;
}

}  // namespace isoatlas::detail::io
