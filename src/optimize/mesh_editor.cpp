// SPDX-License-Identifier: Apache-2.0
#include "optimize/mesh_editor.h"

#include <algorithm>
#include <utility>

#include "core/cancel_poll.h"
#include "core/sort_once.h"

namespace isoatlas::detail {
namespace {

void append(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> from) { to.insert(to.end(), from.begin(), from.end()); }

}  // namespace

MeshEditor::MeshEditor(MeasuredCovering& work, std::vector<DualTriangle>& triangles, IntersectionTracker* meeting,
                       const RunControl& control)
    : work_(work), triangles_(triangles), meeting_(meeting), control_(control), rings_(work.placement().normal_offset.empty() ? 2 : 3) {
  occupied_.assign(work.surface_data().graph.c_vertex_count(), 0);
  for (const CVertexId v : placement().anchor) occupied_[v] = 1;
}

void MeshEditor::set_triangle(std::uint32_t t, const DualTriangle& to) {
  triangles_[t] = to;
  edit_.triangles.push_back(t);
}

void MeshEditor::move(CellId c, CVertexId anchor, Vec3 shift) {
  VertexPlacement& placement = work_.edit_vertex_placement();
  const CVertexId from = std::exchange(placement.anchor[c], anchor);
  occupied_[from] = 0;
  occupied_[anchor] = 1;
  if (placement.displacement.empty() && !(shift == Vec3{})) placement.displacement.resize(mesh().cell_count());
  if (!placement.displacement.empty()) placement.displacement[c] = shift;
  if (from != anchor) set_position(from, surface_data().complex.positions[from]);
  set_position(anchor, base_position(surface_data().complex, placement, c));
  edit_.vertices.push_back(c);
}

void MeshEditor::give_up(CellId c, std::uint8_t what) {
  std::vector<std::uint8_t>& fixed = work_.edit_vertex_placement().fixed;
  fixed.resize(mesh().cell_count(), 0);
  fixed[c] = std::max(fixed[c], what);
  edit_.vertices.push_back(c);
}

void MeshEditor::set_position(CVertexId v, Vec3 position) {
  if (!positions_.empty()) positions_[v] = position;
}

void MeshEditor::measure(std::span<const CellId> concerned) {
  sort_once(edit_.triangles);
  sort_once(edit_.vertices);
  work_.remesh(triangles_, edit_, concerned);
  control_.check_cancelled();
  if (!placement().normal_offset.empty()) append(edit_.vertices, concerned);  // balanced
  append(changed_, edit_.triangles);
  for (const CellId c : edit_.vertices) append(changed_, mesh().triangles_of.row(c));
  append(moved_, edit_.vertices);
  append(remade_, edit_.triangles);
  edit_ = {};
}

std::vector<CellId> MeshEditor::around(std::span<const CellId> cells, int rings) const {
  CancelPoll poll(control_);
  std::vector<CellId> out(cells.begin(), cells.end());
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<CellId> more;
    for (const CellId c : out) {
      poll.step();
      for (const std::uint32_t t : mesh().triangles_of.row(c)) append(more, mesh().triangles[t]);
    }
    sort_once(more);
    out = std::move(more);
  }
  return out;
}

std::vector<CellId> MeshEditor::meeting_corners() {
  if (meeting_ == nullptr) return {};
  if (!std::exchange(does_meeting_know_, true)) {
    moved_.clear();
    remade_.clear();
    return meeting_->update(work_.positions(), to_triangles(triangles_), control_);
  }
  sort_once(moved_);
  std::vector<Vec3> at;
  CancelPoll poll(control_);
  for (const CellId c : moved_) {
    poll.step();
    at.push_back(vertex_position(surface_data().complex, surface_data().surfels, placement(), c));
    append(remade_, mesh().triangles_of.row(c));
  }
  control_.check_cancelled();
  sort_once(remade_);
  std::vector<Triangle> corners;
  for (const std::uint32_t t : remade_) corners.push_back(triangles_[t].cell);
  std::vector<CellId> out = meeting_->update(moved_, at, remade_, corners, control_);
  moved_.clear();
  remade_.clear();
  return out;
}

std::vector<std::uint32_t> MeshEditor::take_changed() {
  sort_once(changed_);
  return std::exchange(changed_, {});
}

std::vector<CellId> MeshEditor::keep_from_straying(std::span<const CellId> cells, std::span<const Vec3> before) {
  if (surface_data().adaptive_surface == nullptr || placement().displacement.empty()) return {};
  if (positions_.empty()) {
    positions_ = surface_data().complex.positions;
    for (CellId c = 0; c < placement().anchor.size(); ++c)
      positions_[placement().anchor[c]] = base_position(surface_data().complex, placement(), c);
  }
  std::vector<std::size_t> movers;
  std::vector<CVertexId> c_vertices;
  std::vector<Vec3> start;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (placement().displacement[cells[i]] == before[i]) continue;
    const CVertexId v = placement().anchor[cells[i]];
    movers.push_back(i);
    c_vertices.push_back(v);
    start.push_back(displaced_position(surface_data().complex, v, before[i]));
  }
  if (movers.empty()) return {};
  control_.check_cancelled();
  std::vector<CVertexId> back = surface_data().adaptive_surface->find_conflicting_moves(c_vertices, start, positions_, c_vertices);
  std::sort(back.begin(), back.end());
  std::vector<CellId> out;
  for (std::size_t k = 0; k < movers.size(); ++k) {
    if (!std::binary_search(back.begin(), back.end(), c_vertices[k])) continue;
    shift(cells[movers[k]], before[movers[k]]);
    out.push_back(cells[movers[k]]);
  }
  return out;
}

}  // namespace isoatlas::detail
