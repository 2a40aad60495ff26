// SPDX-License-Identifier: Apache-2.0
#include "support/surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "isosurface/parse_surface.h"

namespace isoatlas::detail::test {
namespace {

// A grid of quads, n columns (closed in x if round) and m rows.
SurfaceComplex quads(std::uint32_t n, std::uint32_t m, bool round) {
  SurfaceComplex out;
  const double radius = n / (2 * std::numbers::pi);
  for (std::uint32_t y = 0; y < m; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const double angle = 2 * std::numbers::pi * x / n;
      out.positions.push_back(
          round ? Vec3{radius * std::cos(angle), radius * std::sin(angle), static_cast<double>(y)}
                : Vec3{static_cast<double>(x), static_cast<double>(y), 0.5});
      out.on_boundary.push_back(y == 0 || y == m - 1 || (!round && (x == 0 || x == n - 1)));
    }
  }
  const std::uint32_t columns = round ? n : n - 1;
  for (std::uint32_t y = 0; y + 1 < m; ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) {
      const std::uint32_t x1 = (x + 1) % n;
      out.faces.push_back({{x + n * y, x1 + n * y, x1 + n * (y + 1), x + n * (y + 1)}});
    }
  }
  for (std::uint32_t x = 0; x < columns; ++x) {
    const std::uint32_t x1 = (x + 1) % n;
    out.boundary.push_back({x, x1});
    out.boundary.push_back({x1 + n * (m - 1), x + n * (m - 1)});
  }
  for (std::uint32_t y = 0; y + 1 < m && !round; ++y) {
    out.boundary.push_back({n - 1 + n * y, n - 1 + n * (y + 1)});
    out.boundary.push_back({n * (y + 1), n * y});
  }
  return out;
}

}  // namespace

SurfaceComplex surface_of(const Samples& samples, double isovalue, Inside inside, Vec3 spacing,
                          Topology topology) {
  const Volume volume = to_volume(samples, SampleType::int32, spacing);
  ParseOptions options;
  options.rule = {isovalue, inside, NonFinite::refuse};
  options.topology = topology;
  SurfaceComplex out = parse_surface(volume, options);
  if (const std::string wrong = validate(out); !wrong.empty())
    throw std::runtime_error("the parsed surface is not valid: " + wrong);
  return out;
}

TriangleMesh triangles_of(const SurfaceComplex& complex) {
  TriangleMesh out;
  out.positions = complex.positions;
  for (const Face& f : complex.faces) {
    out.triangles.push_back({f.corner[0], f.corner[1], f.corner[2]});
    if (!f.is_triangle()) out.triangles.push_back({f.corner[0], f.corner[2], f.corner[3]});
  }
  return out;
}

MeshCounts count_manifold(const TriangleMesh& mesh) {
  MeshCounts out = count_mesh(mesh);
  if (!out.fault.empty()) throw std::runtime_error("not an oriented manifold: " + out.fault);
  return out;
}

MeshCounts count_manifold(const SurfaceComplex& complex) {
  std::vector<Polygon> faces;
  for (const Face& f : complex.faces)
    faces.push_back(Polygon(f.corner).first(f.corner[3] == kNone ? 3 : 4));
  MeshCounts out = count_polygons(complex.positions.size(), faces);
  if (!out.fault.empty()) throw std::runtime_error("not an oriented manifold: " + out.fault);
  std::vector<DirectedEdge> listed;
  for (const BoundarySide& side : complex.boundary) listed.emplace_back(side.from, side.to);
  std::sort(listed.begin(), listed.end());
  if (listed != out.boundary) throw std::runtime_error("its list of boundary sides is wrong");
  std::vector<std::uint8_t> flags(complex.positions.size(), 0);
  for (const auto& [from, to] : out.boundary) flags[from] = flags[to] = 1;
  if (flags != complex.on_boundary) throw std::runtime_error("its boundary flags are wrong");
  return out;
}

std::vector<TopologySummary::Kind> kinds_of(const TriangleMesh& mesh) {
  return count_manifold(mesh).topology.kinds;
}

std::string text(const std::vector<TopologySummary::Kind>& kinds) {
  std::ostringstream out;
  for (const auto& k : kinds)
    out << k.count << " x (genus " << k.genus << ", " << k.boundary_loops << " loops) ";
  return out.str();
}

SurfaceComplex flat_grid(std::uint32_t n, std::uint32_t m) { return quads(n, m, false); }
SurfaceComplex tube(std::uint32_t n, std::uint32_t m) { return quads(n, m, true); }

SurfaceComplex tetrahedron() {
  SurfaceComplex out;
  out.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  out.on_boundary.assign(4, 0);
  out.faces = {{{0, 2, 1, kNone}}, {{0, 1, 3, kNone}}, {{1, 2, 3, kNone}}, {{2, 0, 3, kNone}}};
  return out;
}

double signed_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    sum += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
           a.z * (b.x * c.y - b.y * c.x);
  }
  return sum / 6;
}

std::pair<Vec3, Vec3> bounding_box(const TriangleMesh& mesh) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const Vec3& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {low, high};
}

std::vector<double> slow_distances(const CVertexGraph& graph,
                                   const std::vector<CVertexId>& sources) {
  std::vector<double> out(graph.c_vertex_count(), std::numeric_limits<double>::infinity());
  for (const CVertexId s : sources) out[s] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (CVertexId v = 0; v < graph.c_vertex_count(); ++v) {
      for (const auto& n : graph.row(v)) {
        if (out[v] + n.weight < out[n.id]) {
          out[n.id] = out[v] + n.weight;
          changed = true;
        }
      }
    }
  }
  return out;
}

}  // namespace isoatlas::detail::test
