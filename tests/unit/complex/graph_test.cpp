// SPDX-License-Identifier: Apache-2.0
#include "complex/c_vertex_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/vector_math.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// Checks the documented properties of rows one by one with sets.
void expect_proper_graph(const SurfaceComplex& surface, const std::string& what) {
  const CVertexGraph graph = make_graph(surface);
  ASSERT_EQ(graph.c_vertex_count(), surface.c_vertex_count());
  std::vector<std::set<CVertexId>> side(surface.c_vertex_count()),
      diagonal(surface.c_vertex_count());
  std::set<std::array<CVertexId, 3>> corner;  // (v, next, previous) of every face, and (v, next,
                                              // diagonal), (v, diagonal, previous)
  for (const Face& f : surface.faces) {
    const int n = f.size();
    for (int k = 0; k < n; ++k) {
      const CVertexId v = f.corner[k], next = f.corner[(k + 1) % n],
                      previous = f.corner[(k + n - 1) % n];
      side[v].insert({next, previous});
      if (n == 4) {
        const CVertexId across = f.corner[(k + 2) % 4];
        diagonal[v].insert(across);
        corner.insert({v, next, across});
        corner.insert({v, across, previous});
      } else {
        corner.insert({v, next, previous});
      }
    }
  }
  for (CVertexId v = 0; v < surface.c_vertex_count(); ++v) {
    const auto row = graph.row(v);
    std::set<CVertexId> sides, diagonals;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool is_diagonal = graph.is_diagonal[graph.first[v] + i] != 0;
      ASSERT_TRUE((is_diagonal ? diagonals : sides).insert(row[i].id).second)
          << what << ": neighbour twice";
      const double d =
          length(to_metric(surface.positions[v] - surface.positions[row[i].id], surface.spacing));
      ASSERT_NEAR(row[i].weight, d, 1e-6 * (1 + d)) << what;
      ASSERT_GT(row[i].weight, 0) << what;
      const bool last = i + 1 == row.size();
      if (last && surface.on_boundary[v]) continue;
      ASSERT_TRUE(corner.count({v, row[i].id, row[last ? 0 : i + 1].id}))
          << what << ": row " << v << " is not in cyclic order";
      ASSERT_FALSE(i == 0 && is_diagonal) << what << ": a row starts with a side";
    }
    ASSERT_EQ(sides, side[v]) << what;
    ASSERT_EQ(diagonals, diagonal[v]) << what;
    if (surface.on_boundary[v]) {
      int ends = 0;
      for (const BoundarySide& s : surface.boundary) {
        ends += (s.from == v && s.to == row.front().id) || (s.to == v && s.from == row.back().id);
      }
      ASSERT_EQ(ends, 2) << what << ": a boundary row runs from one boundary side to the other";
    }
  }
}

TEST(Graph, RowsOfHandMadeComplexes) {
  expect_proper_graph(tetrahedron(), "tetrahedron");
  expect_proper_graph(flat_grid(5, 4), "grid");
  expect_proper_graph(tube(6, 4), "tube");
}

TEST(Graph, RowsOfGeneratedSurfaces) {
  for (const KnownVolume& known : known_volumes()) {
    if (known.samples.values.size() > 6000) continue;  // the check is slow
    expect_proper_graph(surface_of(known.samples, known.isovalue), known.name);
    if (HasFatalFailure()) return;
  }
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {6, 5, 6}, seed);
    if (!has_surface(s, 0)) continue;
    expect_proper_graph(surface_of(s, 0, Inside::above, {1, 2.5, 0.7}), name(family));
    if (HasFatalFailure()) return;
  }
}

// A fan of many triangles about one c-vertex takes the sorted path.
TEST(Graph, CVertexWithManyFaces) {
  constexpr std::uint32_t n = 60;
  for (const bool open : {false, true}) {
    SurfaceComplex fan;
    fan.positions.push_back({0, 0, 0});
    fan.on_boundary.push_back(open);
    const auto spoke = [](std::uint32_t i) {
      return 1 + i * 37 % n;
    };  // ids around the centre in no order
    for (std::uint32_t i = 0; i < n; ++i) fan.positions.push_back({}), fan.on_boundary.push_back(1);
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = (open ? 5.0 : 2 * M_PI) * i / n;
      fan.positions[spoke(i)] = {std::cos(angle), std::sin(angle), 0};
    }
    for (std::uint32_t i = 0; i + (open ? 1 : 0) < n; ++i) {
      fan.faces.push_back({{0, spoke(i), spoke((i + 1) % n), kNone}});
      fan.boundary.push_back({spoke(i), spoke((i + 1) % n)});
    }
    if (open) {
      fan.boundary.push_back({0, spoke(0)});
      fan.boundary.push_back({spoke(n - 1), 0});
    }
    std::rotate(fan.faces.begin(), fan.faces.begin() + 17, fan.faces.end());
    ASSERT_EQ(validate(fan), "");
    expect_proper_graph(fan, open ? "open fan" : "closed fan");
  }
}

// Rows become longer and shorter, move to the left and to the right, or only change their weights;
// and c-vertices are removed, as when a state is restored.
TEST(Graph, RebuildingEqualsBuildingAndReportsChanges) {
  const auto same_row = [](const CVertexGraph& a, const CVertexGraph& b, CVertexId v) {
    return std::ranges::equal(a.row(v), b.row(v)) && a.on_boundary[v] == b.on_boundary[v] &&
           std::equal(a.is_diagonal.begin() + a.first[v], a.is_diagonal.begin() + a.first[v + 1],
                      b.is_diagonal.begin() + b.first[v]);
  };
  Random random(9);
  for (int round = 0; round < 60; ++round) {
    const Samples s = random_samples(Family::white_noise, {5, 4, 5}, random.between(0, 1 << 20));
    if (!has_surface(s, 0)) continue;
    // Quads on the same c-vertices, some of them split along either diagonal.
    const SurfaceComplex quads = surface_of(s, 0);
    const auto some_cut = [&] {
      SurfaceComplex out = quads;
      for (FaceId f = 0; f < quads.face_count(); ++f) {
        const std::array<CVertexId, 4> c = quads.faces[f].corner;
        if (quads.faces[f].is_triangle() || random.between(0, 3) > 0) continue;
        const auto k = static_cast<std::size_t>(random.between(0, 1));
        out.faces[f] = {{c[k], c[k + 1], c[k + 2], kNone}};
        out.faces.push_back({{c[k], c[k + 2], c[(k + 3) % 4], kNone}});
      }
      for (Vec3& p : out.positions) p.x += random.between(0, 20) == 0 ? 0.125 : 0;
      return out;
    };
    CVertexGraph graph = make_graph(some_cut());
    for (int again = 0; again < 4; ++again) {
      const SurfaceComplex next = some_cut();
      const CVertexGraph before = graph, anew = make_graph(next);
      const std::vector<std::uint8_t> changed = rebuild_graph(graph, next);
      ASSERT_EQ(graph.first, anew.first);
      ASSERT_EQ(graph.neighbours, anew.neighbours);
      ASSERT_EQ(graph.is_diagonal, anew.is_diagonal);
      for (CVertexId v = 0; v < changed.size(); ++v)
        ASSERT_EQ(changed[v] != 0, !same_row(before, graph, v)) << v;
    }
    for (const SurfaceComplex& other : {tetrahedron(), quads}) {
      rebuild_graph(graph, other);
      const CVertexGraph anew = make_graph(other);
      ASSERT_EQ(graph.first, anew.first);
      ASSERT_EQ(graph.neighbours, anew.neighbours);
      ASSERT_EQ(graph.is_diagonal, anew.is_diagonal);
      ASSERT_EQ(graph.on_boundary, anew.on_boundary);
    }
  }
}

}  // namespace
}  // namespace isoatlas::detail
