// SPDX-License-Identifier: Apache-2.0
#include "complex/surface_complex.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <utility>

namespace isoatlas::detail {

std::string validate(const SurfaceComplex& complex) {
  // Deliberately uses plain containers and shares nothing with the code it checks.
  const std::uint32_t n = complex.c_vertex_count();
  std::ostringstream out;
  if (complex.on_boundary.size() != n) return "on_boundary has a wrong size";

  std::map<std::pair<CVertexId, CVertexId>, int>
      directed;  // directed side -> faces that run along it
  std::map<std::pair<CVertexId, CVertexId>, std::set<FaceId>>
      diagonals;  // undirected diagonal -> quads
  std::vector<std::vector<std::pair<CVertexId, CVertexId>>> links(
      n);  // per c-vertex (next, previous) in each face
  for (FaceId f = 0; f < complex.face_count(); ++f) {
    const Face& face = complex.faces[f];
    const int size = face.size();
    for (int k = 0; k < size; ++k) {
      const CVertexId a = face.corner[k], b = face.corner[(k + 1) % size];
      if (a >= n) {
        out << "face " << f << ": corner " << a << " out of range";
        return out.str();
      }
      for (int m = k + 1; m < size; ++m) {
        if (face.corner[m] == a) {
          out << "face " << f << ": corner " << a << " twice";
          return out.str();
        }
      }
      if (++directed[{a, b}] > 1) {
        out << "side " << a << "->" << b << " in two faces that run along it in the same sense";
        return out.str();
      }
      links[a].push_back({b, face.corner[(k + size - 1) % size]});
    }
    if (size == 4) {
      for (int k = 0; k < 2; ++k) {
        diagonals[std::minmax(face.corner[k], face.corner[k + 2])].insert(f);
      }
    }
  }
  std::set<std::pair<CVertexId, CVertexId>> boundary;
  std::vector<int> boundary_degree(n, 0);
  for (const BoundarySide& s : complex.boundary) {
    if (!boundary.insert({s.from, s.to}).second) return "a boundary side is listed twice";
    if (!directed.count({s.from, s.to})) return "a boundary side is in no face";
    ++boundary_degree[s.from];
    ++boundary_degree[s.to];
  }
  for (const auto& [side, count] : directed) {
    const bool twin = directed.count({side.second, side.first}) > 0;
    if (twin == (boundary.count(side) > 0)) {
      out << "side " << side.first << "->" << side.second
          << (twin ? " is listed as boundary but has a twin"
                   : " has no twin and is not listed as boundary");
      return out.str();
    }
    if (diagonals.count(std::minmax(side.first, side.second))) {
      out << "side " << side.first << "->" << side.second << " is also a diagonal";
      return out.str();
    }
  }
  for (const auto& [pair, quads] : diagonals) {
    if (quads.size() > 1) {
      out << "diagonal " << pair.first << "-" << pair.second << " in several quads";
      return out.str();
    }
  }
  for (CVertexId v = 0; v < n; ++v) {
    if (links[v].empty()) {
      out << "c-vertex " << v << " is in no face";
      return out.str();
    }
    if ((boundary_degree[v] != 0) != (complex.on_boundary[v] != 0)) {
      out << "c-vertex " << v << ": boundary flag is wrong";
      return out.str();
    }
    // One cycle or one path: walk from a start and count.
    std::map<CVertexId, CVertexId> next;  // neighbour -> next neighbour around v
    for (const auto& [a, b] : links[v]) next[a] = b;
    std::set<CVertexId> targets;
    for (const auto& [a, b] : next) targets.insert(b);
    CVertexId start = links[v][0].first;
    int starts = 0;
    for (const auto& [a, b] : next) {
      if (!targets.count(a)) {
        start = a;
        ++starts;
      }
    }
    if (starts > 1 || (starts == 1) != (boundary_degree[v] == 2) ||
        (boundary_degree[v] != 0 && boundary_degree[v] != 2)) {
      out << "c-vertex " << v << ": its faces are not one fan";
      return out.str();
    }
    std::size_t steps = 0;
    CVertexId at = start;
    do {
      const auto it = next.find(at);
      if (it == next.end()) break;
      at = it->second;
      ++steps;
    } while (at != start && steps <= links[v].size());
    if (steps != links[v].size()) {
      out << "c-vertex " << v << ": its faces are several fans";
      return out.str();
    }
  }
  return {};
}

}  // namespace isoatlas::detail
