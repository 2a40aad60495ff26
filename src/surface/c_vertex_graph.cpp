// SPDX-License-Identifier: Apache-2.0
#include "surface/c_vertex_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/vector_math.h"

namespace isoatlas {
namespace {

constexpr std::size_t kRows = 4096;  // per piece of a parallel loop

// One face at a c-vertex, as the number of this corner of it.
using Wedge = std::uint32_t;

struct Corner {  // of a face: the neighbours before and after it, and the diagonal between
  CVertexId next, diagonal, previous;
};

Corner corner_of(const SurfaceComplex& complex, Wedge wedge) {
  const Face& face = complex.faces[wedge / 4];
  const auto k = static_cast<int>(wedge % 4);
  const int size = face.size();
  return {face.corner[(k + 1) % size], size == 4 ? face.corner[(k + 2) % 4] : kNone, face.corner[(k + size - 1) % size]};
}

}  // namespace

CVertexGraph make_graph(const SurfaceComplex& complex, const RunControl* control) {
  const std::uint32_t n = complex.c_vertex_count();
  checked_id(8 * complex.faces.size() + complex.boundary.size(), "edges of the graph");
  CVertexGraph graph;
  graph.on_boundary = complex.on_boundary;

  CancelPoll poll(control);
  std::vector<std::uint32_t> first_wedge(n + 1, 0);
  std::vector<std::uint32_t> diagonals(n, 0);
  for (const Face& face : complex.faces) {
    for (int k = 0; k < face.size(); ++k) {
      ++first_wedge[face.corner[k] + 1];
      diagonals[face.corner[k]] += face.is_triangle() ? 0 : 1;
    }
  }
  for (CVertexId v = 0; v < n; ++v) first_wedge[v + 1] += first_wedge[v];
  std::vector<Wedge> wedges(first_wedge[n]);
  {
    std::vector<std::uint32_t> fill(first_wedge.begin(), first_wedge.end() - 1);
    for (FaceId f = 0; f < complex.face_count(); ++f) {
      poll.step();
      const Face& face = complex.faces[f];
      for (int k = 0; k < face.size(); ++k) wedges[fill[face.corner[k]]++] = 4 * f + static_cast<Wedge>(k);
    }
  }

  graph.first.resize(n + 1);
  graph.first[0] = 0;
  for (CVertexId v = 0; v < n; ++v) {
    const std::uint32_t faces = first_wedge[v + 1] - first_wedge[v];
    graph.first[v + 1] = graph.first[v] + faces + diagonals[v] + (complex.on_boundary[v] ? 1 : 0);
  }
  graph.neighbours.resize(graph.first[n]);
  graph.is_diagonal.assign(graph.first[n], 0);

  // Chain the wedges of each c-vertex: counter-clockwise, the wedge that starts where the last one ended.
  constexpr std::uint32_t kFew = 24;
  for_each_index(n, kRows, control, [&](std::size_t row) {
    const auto v = static_cast<CVertexId>(row);
    const std::uint32_t count = first_wedge[v + 1] - first_wedge[v];
    std::array<Corner, kFew> few;
    std::vector<Corner> many;
    if (count > kFew) many.resize(count);
    Corner* const begin = count > kFew ? many.data() : few.data();
    Corner* const end = begin + count;
    for (std::uint32_t k = 0; k < count; ++k) begin[k] = corner_of(complex, wedges[first_wedge[v] + k]);
    const auto by_next = [](const Corner& w, CVertexId id) { return w.next < id; };
    const bool sorted = count > kFew;
    if (sorted) std::sort(begin, end, [](const Corner& a, const Corner& b) { return a.next < b.next; });
    const auto starting_at = [&](CVertexId id) -> Corner* {
      if (sorted) {
        Corner* w = std::lower_bound(begin, end, id, by_next);
        return w != end && w->next == id ? w : nullptr;
      }
      for (Corner* w = begin; w != end; ++w) {
        if (w->next == id) return w;
      }
      return nullptr;
    };
    const Corner* at = begin;
    if (complex.on_boundary[v]) {  // start with the wedge that no other wedge leads to
      std::vector<CVertexId> ends;
      for (const Corner* w = begin; w != end; ++w) ends.push_back(w->previous);
      std::sort(ends.begin(), ends.end());
      while (std::binary_search(ends.begin(), ends.end(), at->next)) ++at;
    }
    std::uint32_t out = graph.first[v];
    const auto push = [&](CVertexId id, bool diagonal) {
      const double d = std::sqrt(squared_distance(complex.positions[v], complex.positions[id], complex.spacing));
      graph.neighbours[out] = {id, static_cast<float>(d)};
      graph.is_diagonal[out++] = diagonal;
    };
    for (std::uint32_t k = 0; k < count; ++k) {
      push(at->next, false);
      if (at->diagonal != kNone) push(at->diagonal, true);
      if (k + 1 == count) {
        if (complex.on_boundary[v]) push(at->previous, false);
      } else {
        at = starting_at(at->previous);
      }
    }
  });
  return graph;
}

std::vector<std::uint8_t> remake_graph(CVertexGraph& graph, const SurfaceComplex& complex, const RunControl* control) {
  const CVertexGraph before = std::exchange(graph, make_graph(complex, control));
  std::vector<std::uint8_t> out(graph.c_vertex_count(), 1);
  for_each_index(std::min(before.c_vertex_count(), graph.c_vertex_count()), kRows, [&](std::size_t row) {
    const auto v = static_cast<CVertexId>(row);
    out[v] = before.on_boundary[v] != graph.on_boundary[v] || !std::ranges::equal(before.row(v), graph.row(v));
  });
  return out;
}

}  // namespace isoatlas
