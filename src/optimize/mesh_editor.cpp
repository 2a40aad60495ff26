// SPDX-License-Identifier: Apache-2.0
#include "optimize/mesh_editor.h"

#include <algorithm>
#include <utility>

#include "core/cancel_poll.h"
#include "core/sort_once.h"

namespace isoatlas::detail {
namespace {

void append(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

MeshEditor::MeshEditor(MeasuredCovering& measured, std::vector<DualTriangle>& triangles,
                       IntersectionTracker* tracker, const RunControl& control)
    : measured_(measured),
      triangles_(triangles),
      tracker_(tracker),
      control_(control),
      affected_ring_(measured.placement().normal_offset.empty() ? 2 : 3) {
  occupied_.assign(measured.surface_data().graph.c_vertex_count(), 0);
  for (const CVertexId v : placement().anchor) occupied_[v] = 1;
}

void MeshEditor::set_triangle(std::uint32_t t, const DualTriangle& to) {
  triangles_[t] = to;
  edit_.triangles.push_back(t);
}

void MeshEditor::move(CellId c, CVertexId anchor, Vec3 displacement) {
  VertexPlacement& placement = measured_.edit_vertex_placement();
  const CVertexId from = std::exchange(placement.anchor[c], anchor);
  occupied_[from] = 0;
  occupied_[anchor] = 1;
  if (placement.displacement.empty() && !(displacement == Vec3{}))
    placement.displacement.resize(mesh().cell_count());
  if (!placement.displacement.empty()) placement.displacement[c] = displacement;
  if (from != anchor) set_position(from, surface_data().complex.positions[from]);
  set_position(anchor, base_position(surface_data().complex, placement, c));
  edit_.vertices.push_back(c);
}

void MeshEditor::fix(CellId c, std::uint8_t degree) {
  std::vector<std::uint8_t>& fixed = measured_.edit_vertex_placement().fixed;
  fixed.resize(mesh().cell_count(), 0);
  fixed[c] = std::max(fixed[c], degree);
  edit_.vertices.push_back(c);
}

void MeshEditor::set_position(CVertexId v, Vec3 position) {
  if (!positions_.empty()) positions_[v] = position;
}

void MeshEditor::measure(std::span<const CellId> affected) {
  sort_unique_ids(edit_.triangles);
  sort_unique_ids(edit_.vertices);
  measured_.remesh(triangles_, edit_, affected);
  control_.check_cancelled();
  if (!placement().normal_offset.empty())
    append(edit_.vertices, affected);  // balancing may have moved them
  append(changed_, edit_.triangles);
  for (const CellId c : edit_.vertices) append(changed_, mesh().triangles_of.row(c));
  append(moved_, edit_.vertices);
  append(changed_since_test_, edit_.triangles);
  edit_ = {};
}

std::vector<CellId> MeshEditor::k_ring(std::span<const CellId> cells, int k) const {
  CancelPoll poll(control_);
  std::vector<CellId> out(cells.begin(), cells.end());
  for (int ring = 0; ring < k; ++ring) {
    std::vector<CellId> more;
    for (const CellId c : out) {
      poll.step();
      for (const std::uint32_t t : mesh().triangles_of.row(c)) append(more, mesh().triangles[t]);
    }
    sort_unique_ids(more);
    out = std::move(more);
  }
  return out;
}

std::vector<CellId> MeshEditor::intersecting_corners() {
  if (tracker_ == nullptr) return {};
  if (!std::exchange(is_tracker_current_, true)) {
    moved_.clear();
    changed_since_test_.clear();
    return tracker_->update(measured_.positions(), to_triangles(triangles_), control_);
  }
  sort_unique_ids(moved_);
  std::vector<Vec3> at;
  CancelPoll poll(control_);
  for (const CellId c : moved_) {
    poll.step();
    at.push_back(vertex_position(surface_data().complex, surface_data().surfels, placement(), c));
    append(changed_since_test_, mesh().triangles_of.row(c));
  }
  control_.check_cancelled();
  sort_unique_ids(changed_since_test_);
  std::vector<Triangle> corners;
  for (const std::uint32_t t : changed_since_test_) corners.push_back(triangles_[t].cell);
  std::vector<CellId> out = tracker_->update(moved_, at, changed_since_test_, corners, control_);
  moved_.clear();
  changed_since_test_.clear();
  return out;
}

std::vector<std::uint32_t> MeshEditor::take_changed_triangles() {
  sort_unique_ids(changed_);
  return std::exchange(changed_, {});
}

std::vector<CellId> MeshEditor::revert_conflicting_moves(std::span<const CellId> cells,
                                                         std::span<const Vec3> before) {
  if (surface_data().adaptive_surface == nullptr || placement().displacement.empty()) return {};
  if (positions_.empty()) {
    positions_ = surface_data().complex.positions;
    for (CellId c = 0; c < placement().anchor.size(); ++c)
      positions_[placement().anchor[c]] = base_position(surface_data().complex, placement(), c);
  }
  std::vector<std::size_t> displaced_cells;
  std::vector<CVertexId> c_vertices;
  std::vector<Vec3> start;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (placement().displacement[cells[i]] == before[i]) continue;
    const CVertexId v = placement().anchor[cells[i]];
    displaced_cells.push_back(i);
    c_vertices.push_back(v);
    start.push_back(displaced_position(surface_data().complex, v, before[i]));
  }
  if (displaced_cells.empty()) return {};
  control_.check_cancelled();
  std::vector<CVertexId> conflicting = surface_data().adaptive_surface->find_conflicting_moves(
      c_vertices, start, positions_, c_vertices);
  std::sort(conflicting.begin(), conflicting.end());
  std::vector<CellId> out;
  for (std::size_t k = 0; k < displaced_cells.size(); ++k) {
    if (!std::binary_search(conflicting.begin(), conflicting.end(), c_vertices[k])) continue;
    displace(cells[displaced_cells[k]], before[displaced_cells[k]]);
    out.push_back(cells[displaced_cells[k]]);
  }
  return out;
}

}  // namespace isoatlas::detail
