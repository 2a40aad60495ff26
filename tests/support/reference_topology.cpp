// SPDX-License-Identifier: Apache-2.0
#include "support/reference_topology.h"

#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace isoatlas::detail::test {
namespace {

__extension__ using Exact = __int128;  // GCC and clang have it, ISO C++ does not
using Place = std::array<int, 3>;  // twice the index: odd along one axis for grid edges, two for
                                   // faces, three for cells

struct Counter {
  const Samples& samples;
  std::int64_t twice_isovalue;
  std::int64_t sign;  // -1 for Inside::below: the same as negating samples and isovalue

  Exact above(Place p) const {  // twice (value - isovalue), positive or zero inside
    const std::int64_t v =
        samples.at(static_cast<std::size_t>(p[0] / 2), static_cast<std::size_t>(p[1] / 2),
                   static_cast<std::size_t>(p[2] / 2));
    return static_cast<Exact>(sign) * (2 * static_cast<Exact>(v) - twice_isovalue);
  }
  bool inside(Place p) const { return above(p) >= 0; }

  using Segment = std::pair<Place, Place>;  // between two nodes

  // The segments on the grid face around `face` (odd along u and v).
  std::vector<Segment> segments(Place face) const {
    int axes[2], n = 0;
    for (int a = 0; a < 3; ++a) {
      if (face[a] % 2 != 0) axes[n++] = a;
    }
    const auto at = [&](int du, int dv) {
      Place p = face;
      p[axes[0]] += du;
      p[axes[1]] += dv;
      return p;
    };
    // Corners and edges once around.
    const Place corner[4] = {at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)};
    const Place edge[4] = {at(0, -1), at(1, 0), at(0, 1),
                           at(-1, 0)};  // edge k from corner k to corner k + 1
    std::vector<Place> nodes;
    for (int k = 0; k < 4; ++k) {
      if (inside(corner[k]) != inside(corner[(k + 1) % 4])) nodes.push_back(edge[k]);
    }
    if (nodes.empty()) return {};
    if (nodes.size() == 2) return {{nodes[0], nodes[1]}};
    // Asymptotic decider: the bilinear saddle is (f0 f2 - f1 f3) / (f0 + f2 - f1 - f3).
    const Exact numerator =
        above(corner[0]) * above(corner[2]) - above(corner[1]) * above(corner[3]);
    const Exact denominator =
        above(corner[0]) + above(corner[2]) - above(corner[1]) - above(corner[3]);
    const bool saddle_inside = numerator == 0 || (numerator > 0) == (denominator > 0);
    // A segment cuts off each corner that is not of the saddle's kind: its two edges are k - 1 and
    // k.
    std::vector<Segment> out;
    for (int k = 0; k < 4; ++k) {
      if (inside(corner[k]) != saddle_inside) out.push_back({edge[(k + 3) % 4], edge[k]});
    }
    return out;
  }
};

struct Pieces {  // union-find over whatever can be a key
  std::map<Place, Place> parent;
  Place find(Place p) {
    while (parent.at(p) != p) p = parent.at(p) = parent.at(parent.at(p));
    return p;
  }
};

}  // namespace

bool has_surface(const Samples& samples, double isovalue, Inside inside) {
  std::set<bool> sides;
  for (const std::int64_t v : samples.values) {
    const auto x = static_cast<double>(v);
    sides.insert(inside == Inside::above ? x >= isovalue : x <= isovalue);
  }
  return sides.size() == 2;
}

TopologySummary reference_topology(const Samples& samples, double isovalue, Inside inside) {
  if (std::floor(2 * isovalue) != 2 * isovalue)
    throw std::logic_error("reference_topology takes whole and half isovalues");
  const Counter counter{samples, static_cast<std::int64_t>(2 * isovalue),
                        inside == Inside::above ? 1 : -1};
  const int size[3] = {static_cast<int>(2 * (samples.size[0] - 1)),
                       static_cast<int>(2 * (samples.size[1] - 1)),
                       static_cast<int>(2 * (samples.size[2] - 1))};

  Pieces pieces;
  std::map<Place, std::vector<Counter::Segment>> faces;
  Place p;
  for (p[2] = 0; p[2] <= size[2]; ++p[2]) {
    for (p[1] = 0; p[1] <= size[1]; ++p[1]) {
      for (p[0] = 0; p[0] <= size[0]; ++p[0]) {
        const int odd = p[0] % 2 + p[1] % 2 + p[2] % 2;
        if (odd == 1) {
          Place low = p, high = p;
          for (int a = 0; a < 3; ++a) {
            if (p[a] % 2 != 0) {
              --low[a];
              ++high[a];
            }
          }
          if (counter.inside(low) != counter.inside(high)) pieces.parent[p] = p;
        } else if (odd == 2) {
          auto segments = counter.segments(p);
          if (!segments.empty()) faces[p] = std::move(segments);
        }
      }
    }
  }
  for (const auto& [face, segments] : faces) {
    for (const auto& [a, b] : segments) pieces.parent[pieces.find(a)] = pieces.find(b);
  }

  std::map<Place, ComponentTopology> components;
  for (const auto& [node, parent] : pieces.parent)
    components[pieces.find(node)].euler_characteristic += 1;
  std::multimap<Place, Place> boundary;  // in both directions along segments on the volume's faces
  for (const auto& [face, segments] : faces) {
    const bool on_volume_boundary = [&] {
      for (int a = 0; a < 3; ++a) {
        if (face[a] % 2 == 0 && (face[a] == 0 || face[a] == size[a])) return true;
      }
      return false;
    }();
    for (const auto& [a, b] : segments) {
      components[pieces.find(a)].euler_characteristic -= 1;
      if (on_volume_boundary) {
        boundary.insert({a, b});
        boundary.insert({b, a});
      }
    }
  }

  // Loops of each cell: every node has one segment in each of the two faces of the cell beside it.
  for (p[2] = 1; p[2] < size[2]; p[2] += 2) {
    for (p[1] = 1; p[1] < size[1]; p[1] += 2) {
      for (p[0] = 1; p[0] < size[0]; p[0] += 2) {
        std::vector<Counter::Segment> left;
        for (int a = 0; a < 3; ++a) {
          for (const int step : {-1, 1}) {
            Place face = p;
            face[a] += step;
            if (const auto it = faces.find(face); it != faces.end())
              left.insert(left.end(), it->second.begin(), it->second.end());
          }
        }
        while (!left.empty()) {
          const Place start = left.back().first;
          Place at = left.back().second;
          left.pop_back();
          while (at != start) {
            bool found = false;
            for (std::size_t i = 0; i < left.size() && !found; ++i) {
              if (left[i].first != at && left[i].second != at) continue;
              at = left[i].first == at ? left[i].second : left[i].first;
              left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
              found = true;
            }
            if (!found) throw std::logic_error("reference_topology: a loop does not close");
          }
          components[pieces.find(start)].euler_characteristic += 1;
        }
      }
    }
  }

  // Boundary loops: the connected pieces of the graph of these segments.
  std::set<Place> seen;
  for (const auto& entry : boundary) {
    if (!seen.insert(entry.first).second) continue;
    components[pieces.find(entry.first)].boundary_loops += 1;
    std::vector<Place> stack{entry.first};
    while (!stack.empty()) {
      const Place at = stack.back();
      stack.pop_back();
      const auto [begin, end] = boundary.equal_range(at);
      for (auto it = begin; it != end; ++it) {
        if (seen.insert(it->second).second) stack.push_back(it->second);
      }
    }
  }

  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> kinds;
  TopologySummary out;
  for (const auto& [root, c] : components) {
    if ((2 - c.boundary_loops - c.euler_characteristic) % 2 != 0)
      throw std::logic_error("reference_topology: half a handle");
    const std::int64_t genus = (2 - c.boundary_loops - c.euler_characteristic) / 2;
    ++kinds[{genus, c.boundary_loops}];
    ++out.components;
    out.euler_characteristic += c.euler_characteristic;
    out.genus += genus;
    out.boundary_loops += c.boundary_loops;
  }
  for (const auto& [kind, count] : kinds) out.kinds.push_back({kind.first, kind.second, count});
  return out;
}

}  // namespace isoatlas::detail::test
