// SPDX-License-Identifier: Apache-2.0
#include "complex/c_vertex_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "complex/complex_adjacency.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"

namespace isoatlas::detail {
namespace {

constexpr std::size_t kRowsPerChunk = 4096;  // rows per piece of a parallel loop

struct Corner {  // a face's corner at a c-vertex: the next and previous neighbour and the diagonal
                 // between them
  CVertexId next, diagonal, previous;
};

Corner corner_at(const Face& face, CVertexId v) {
  const int size = face.size();
  int k = 0;
  while (face.corner[k] != v) ++k;
  return {face.corner[(k + 1) % size], size == 4 ? face.corner[(k + 2) % 4] : kNone,
          face.corner[(k + size - 1) % size]};
}

// Builds the rows of a complex's graph one by one.
class GraphRowBuilder {
 public:
  GraphRowBuilder(const SurfaceComplex& complex, const RunControl* control)
      : complex_(complex), adjacency_(complex, control != nullptr ? *control : RunControl()) {}

  std::uint32_t size(CVertexId v) const {
    std::uint32_t out = complex_.on_boundary[v] ? 1 : 0;
    for (const FaceId f : adjacency_.faces_of(v)) out += complex_.faces[f].is_triangle() ? 1 : 2;
    return out;
  }

  struct Row {
    std::vector<CVertexGraph::Neighbour> neighbours;
    std::vector<std::uint8_t> is_diagonal;
  };

  // Chains the faces' corners at a c-vertex counter-clockwise: each starts where the previous one
  // ends.
  void make(CVertexId v, Row& row) const {
    row.neighbours.clear();
    row.is_diagonal.clear();
    const std::span<const FaceId> faces = adjacency_.faces_of(v);
    const std::size_t count = faces.size();
    std::array<Corner, kMaxLocalCorners> few;
    std::vector<Corner> many;
    if (count > kMaxLocalCorners) many.resize(count);
    const std::span<Corner> corners =
        count > kMaxLocalCorners ? std::span(many) : std::span(few).first(count);
    for (std::size_t k = 0; k < count; ++k) corners[k] = corner_at(complex_.faces[faces[k]], v);
    if (count > kMaxLocalCorners) ranges::sort(corners, {}, &Corner::next);
    const auto starting_at = [&](CVertexId id) {
      return count > kMaxLocalCorners ? ranges::lower_bound(corners, id, {}, &Corner::next)
                                      : ranges::find(corners, id, &Corner::next);
    };
    auto at = corners.begin();
    if (complex_.on_boundary[v]) {  // starts with the corner that no other one leads to
      std::vector<CVertexId> ends;
      for (const Corner& c : corners) ends.push_back(c.previous);
      std::sort(ends.begin(), ends.end());
      while (std::binary_search(ends.begin(), ends.end(), at->next)) ++at;
    }
    const auto push = [&](CVertexId id, bool diagonal) {
      const double d = std::sqrt(
          squared_distance(complex_.positions[v], complex_.positions[id], complex_.spacing));
      const auto kind = complex_.on_boundary[v], other = complex_.on_boundary[id];
      const bool leaves_seam =
          std::min(kind, other) == kInterior && std::max(kind, other) == kOnSharedFace;
      row.neighbours.push_back({id, static_cast<float>(d) + (leaves_seam ? kSeamWeight : 0.0f)});
      row.is_diagonal.push_back(diagonal);
    };
    for (std::size_t k = 0; k < count; ++k) {
      push(at->next, false);
      if (at->diagonal != kNone) push(at->diagonal, true);
      if (k + 1 < count) {
        at = starting_at(at->previous);
      } else if (complex_.on_boundary[v]) {
        push(at->previous, false);
      }
    }
  }

 private:
  static constexpr std::size_t kMaxLocalCorners = 24;
  const SurfaceComplex& complex_;
  ComplexAdjacency adjacency_;
};

// Resizes rows and moves those that have not changed; the caller fills in the others.
template <class Item>
void relocate_rows(std::vector<Item>& items, std::span<const std::uint32_t> from,
                   std::span<const std::uint32_t> to, std::span<const std::uint8_t> changed) {
  const std::size_t old_count = std::min(from.size(), to.size()) - 1, total = to.back();
  if (total > items.capacity()) items.reserve(total + total / 8);
  items.resize(std::max<std::size_t>(items.size(), total));
  const auto begin = items.begin();
  // Rows that move to the left are moved first: they never overwrite a row that still has to move
  // to the right.
  for (std::size_t v = 0; v < old_count; ++v) {
    if (!changed[v] && to[v] < from[v])
      std::copy(begin + from[v], begin + from[v + 1], begin + to[v]);
  }
  for (std::size_t v = old_count; v-- > 0;) {
    if (!changed[v] && to[v] > from[v])
      std::copy_backward(begin + from[v], begin + from[v + 1], begin + to[v + 1]);
  }
  items.resize(total);
}

}  // namespace

CVertexGraph make_graph(const SurfaceComplex& complex, const RunControl* control) {
  CVertexGraph graph;
  graph.first.assign(1, 0);
  rebuild_graph(graph, complex, control);
  return graph;
}

std::vector<std::uint8_t> rebuild_graph(CVertexGraph& graph, const SurfaceComplex& complex,
                                        const RunControl* control) {
  const std::uint32_t n = complex.c_vertex_count(), old_count = std::min(n, graph.c_vertex_count());
  checked_id(8 * complex.faces.size() + complex.boundary.size(), "edges of the graph");
  const GraphRowBuilder rows(complex, control);
  std::vector<std::uint8_t> changed(n, 1);
  std::vector<std::uint32_t> first(n + 1, 0);
  const auto is_unchanged = [&](CVertexId v, const GraphRowBuilder::Row& row) {
    return graph.on_boundary[v] == complex.on_boundary[v] &&
           ranges::equal(graph.row(v), row.neighbours) &&
           std::equal(row.is_diagonal.begin(), row.is_diagonal.end(),
                      graph.is_diagonal.begin() + graph.first[v]);
  };
  for_each_chunk(n, kRowsPerChunk, [&](std::size_t begin, std::size_t end) {
    if (control != nullptr) control->check_cancelled();
    GraphRowBuilder::Row row;
    for (auto v = static_cast<CVertexId>(begin); v < end; ++v) {
      first[v + 1] = rows.size(v);
      if (v >= old_count) continue;
      rows.make(v, row);
      changed[v] = !is_unchanged(v, row);
    }
  });
  for (CVertexId v = 0; v < n; ++v) first[v + 1] += first[v];
  relocate_rows(graph.neighbours, graph.first, first, changed);
  relocate_rows(graph.is_diagonal, graph.first, first, changed);
  graph.first = std::move(first);
  graph.on_boundary = complex.on_boundary;
  for_each_chunk(n, kRowsPerChunk, [&](std::size_t begin, std::size_t end) {
    if (control != nullptr) control->check_cancelled();
    GraphRowBuilder::Row row;
    for (auto v = static_cast<CVertexId>(begin); v < end; ++v) {
      if (!changed[v]) continue;
      rows.make(v, row);
      ranges::copy(row.neighbours, graph.neighbours.begin() + graph.first[v]);
      ranges::copy(row.is_diagonal, graph.is_diagonal.begin() + graph.first[v]);
    }
  });
  return changed;
}

}  // namespace isoatlas::detail
