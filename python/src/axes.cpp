// SPDX-License-Identifier: Apache-2.0
#include "axes.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace isoatlas::detail::python {
namespace {

using Triple = std::array<double, 3>;

Triple triple(Vec3 v) { return {v.x, v.y, v.z}; }

/// Converts from LPS to the given space, or back: the conversion is its own inverse.
Vec3 negated_if_ras(Vec3 p, Space space) { return space == Space::ras ? Vec3{-p.x, -p.y, p.z} : p; }

void reverse_triangles(std::vector<Triangle>& triangles) {
  for (Triangle& t : triangles) std::swap(t[1], t[2]);
}

}  // namespace

bool Axes::is_mirrored() const {
  int swaps = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < i; ++j) swaps += of_[j] > of_[i] ? 1 : 0;
  return swaps % 2 == 1;
}

Vec3 Axes::to_library(Vec3 caller) const {
  const Triple c = triple(caller);
  return {c[of_[0]], c[of_[1]], c[of_[2]]};
}

Vec3 Axes::to_caller(Vec3 library) const {
  const Triple l = triple(library);
  Triple c{};
  for (std::size_t k = 0; k < 3; ++k) c[of_[k]] = l[k];
  return {c[0], c[1], c[2]};
}

Grid Axes::to_library(const Grid& caller) const {
  Grid grid = caller;  // copies the unit
  grid.spacing = to_library(caller.spacing);
  grid.origin = to_library(caller.origin);
  for (std::size_t k = 0; k < 3; ++k) {
    grid.size[k] = caller.size[of_[k]];
    grid.direction[k] = to_library(caller.direction[of_[k]]);
  }
  return grid;
}

void Axes::to_library(TriangleMesh& mesh, Space space) const {
  if (is_same()) return;
  for (Vec3& p : mesh.positions) p = to_library(negated_if_ras(p, space));
  if (is_mirrored()) reverse_triangles(mesh.triangles);
}

void Axes::to_caller(Measurement& measurement, Space space) const {
  if (is_same()) return;
  for (OneSidedDistance* side : {&measurement.mesh_to_surface, &measurement.surface_to_mesh}) {
    side->farthest = negated_if_ras(to_caller(side->farthest), space);
  }
}

void Axes::to_caller(Extraction& extraction, Space space) const {
  if (is_same()) return;
  const auto convert = [&](Vec3& p) { p = negated_if_ras(to_caller(p), space); };
  const auto convert_box = [&](BoundingBox& box) {
    convert(box.low);
    convert(box.high);
    const auto [low, high] = box;
    box.low = {std::min(low.x, high.x), std::min(low.y, high.y), std::min(low.z, high.z)};
    box.high = {std::max(low.x, high.x), std::max(low.y, high.y), std::max(low.z, high.z)};
  };
  Hierarchy& hierarchy = extraction.hierarchy;
  for (Vec3& p : hierarchy.positions) convert(p);
  if (hierarchy.float32_origin) convert(*hierarchy.float32_origin);
  for (Hierarchy::Level& level : hierarchy.levels) {
    for (Vec3& p : level.own_positions) convert(p);
    if (is_mirrored()) reverse_triangles(level.triangles);
  }
  for (RankedComponent& component : extraction.report.kept) convert(component.position);
  for (RankedComponent& component : extraction.report.dropped) convert(component.position);
  for (LevelReport& level : extraction.report.levels) {
    for (CellAtLimit& cell : level.at_limit) convert(cell.position);
    for (Vec3& p : level.self_intersection_positions) convert(p);
    for (BadTriangle& triangle : level.bad_triangles) convert(triangle.position);
    convert_box(level.extent.bounds);
    for (ComponentExtent& component : level.extent.largest) convert_box(component.bounds);
    if (level.measured) to_caller(*level.measured, space);
  }
}

}  // namespace isoatlas::detail::python
