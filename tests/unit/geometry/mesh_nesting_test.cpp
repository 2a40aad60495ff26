// SPDX-License-Identifier: Apache-2.0
// Nesting and orientation of components: against the parser's integers, and where doubles do not
// suffice.
#include "geometry/mesh_nesting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "complex/components.h"
#include "isoatlas/mesh.h"
#include "isosurface/parse_surface.h"
#include "isosurface/surface_nesting.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// A tetrahedron about `centre`; a negative `size` inverts it.
void append_tetrahedron(TriangleMesh& mesh, Vec3 centre, double size) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3 d : {Vec3{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}) {
    mesh.positions.push_back({centre.x + std::fabs(size) * d.x, centre.y + std::fabs(size) * d.y,
                              centre.z + std::fabs(size) * d.z});
  }
  for (const Triangle& t : {Triangle{0, 1, 3}, {0, 2, 1}, {0, 3, 2}, {1, 2, 3}}) {
    mesh.triangles.push_back(size > 0 ? Triangle{first + t[0], first + t[1], first + t[2]}
                                      : Triangle{first + t[0], first + t[2], first + t[1]});
  }
}

Nesting nesting_of(const TriangleMesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  std::vector<std::uint8_t> is_open;
  for (const ComponentTopology& component : topology.components)
    is_open.push_back(component.boundary_loops > 0 ? 1 : 0);
  return mesh_nesting(mesh.positions, mesh.triangles, topology.component_of_vertex, is_open);
}

TEST(MeshNesting, OfTetrahedraInEachOther) {
  TriangleMesh mesh;
  append_tetrahedron(mesh, {0, 0, 0}, -3);   // in component 2, inverted
  append_tetrahedron(mesh, {50, 0, 0}, 3);   // next to the others
  append_tetrahedron(mesh, {0, 0, 0}, 12);   // encloses all but component 1
  append_tetrahedron(mesh, {0, 0, 0}, 0.5);  // in component 0
  append_tetrahedron(mesh, {4, 4, 4}, 0.5);  // in component 2
  EXPECT_EQ(nesting_of(mesh), (Nesting{{-1, 1, 1, 1, 1}, {2, kNone, kNone, 0, 2}}));
}

TEST(MeshNesting, OpenComponentsEncloseNothing) {
  TriangleMesh mesh;
  append_tetrahedron(mesh, {0, 0, 0}, 12);
  mesh.triangles.pop_back();
  append_tetrahedron(mesh, {0, 0, 0}, 1);
  EXPECT_EQ(nesting_of(mesh), (Nesting{{0, 1}, {kNone, kNone}}));
}

// The ray from the lowest vertex intersects vertices, edges and planes of the others.
TEST(MeshNesting, RaysThroughVerticesAndEdges) {
  TriangleMesh mesh;
  append_tetrahedron(mesh, {0, 0, 0}, 4);
  append_tetrahedron(mesh, {0, 0, 0}, 0.25);
  append_tetrahedron(mesh, {12, 0, 0}, 4);  // behind the first one along the ray
  append_tetrahedron(mesh, {12, 0, 0}, 0.25);
  append_tetrahedron(mesh, {24, 4, 4}, 1);  // whose ray intersects vertices of both
  append_tetrahedron(mesh, {24, 3, 3}, 1);
  EXPECT_EQ(nesting_of(mesh).parent,
            (std::vector<std::uint32_t>{kNone, 0, kNone, 2, kNone, kNone}));
}

// Flat up to one unit in the last place: the sign of the volume must equal that of exact
// arithmetic.
TEST(MeshNesting, SignsThatDoublesDoNotDetermine) {
  const double a = 1e9, up = std::nextafter(a, 2 * a);
  TriangleMesh flat;
  flat.positions = {{a, a, a}, {a + 1, a, a}, {a, a + 1, a}, {a + 0.25, a + 0.25, up}};
  flat.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(nesting_of(flat).facing, (std::vector<std::int8_t>{1}));
  for (Triangle& t : flat.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(nesting_of(flat).facing, (std::vector<std::int8_t>{-1}));
  flat.positions[3].z = a;
  EXPECT_EQ(nesting_of(flat).facing, (std::vector<std::int8_t>{0})) << "no volume";
  TriangleMesh tiny;
  append_tetrahedron(tiny, {0, 0, 0}, 1e-110);  // its volume is not a double
  EXPECT_EQ(nesting_of(tiny).facing, (std::vector<std::int8_t>{1}));
}

// The complexes of random volumes, whose nesting is known from the parser's integers.
TEST(MeshNesting, OfParsedSurfacesEqualsThatOfTheirNodes) {
  std::size_t enclosed = 0, inward = 0;
  const auto family_of = [](std::uint64_t seed) {
    return std::array{Family::smooth_blobs, Family::sparse_specks, Family::gyroid_cut}[seed % 3];
  };
  for (const bool is_shells : {false, true}) {
    for (std::uint64_t seed = 0; seed < (is_shells ? 60U : 180U); ++seed) {
      const Volume volume = to_volume(
          is_shells ? random_shells(seed) : random_samples(family_of(seed), {9, 10, 11}, seed));
      for (const Inside inside : {Inside::above, Inside::below}) {
        ParseOptions options;
        options.rule.inside = inside;
        std::vector<VerticalNode> nodes;
        const SurfaceComplex surface = parse_surface(volume, options, {}, &nodes);
        const Components components = find_components(surface);
        TriangleMesh mesh;
        mesh.positions = surface.positions;
        mesh.triangles = triangles_of(surface).triangles;
        std::vector<std::uint8_t> is_open;
        for (const ComponentTopology& component : components.topology)
          is_open.push_back(component.boundary_loops > 0 ? 1 : 0);
        const Nesting wanted = surface_nesting(components, nodes);
        ASSERT_EQ(mesh_nesting(mesh.positions, mesh.triangles, components.of_c_vertex, is_open),
                  wanted)
            << (is_shells ? "shells " : name(family_of(seed))) << " " << seed
            << (inside == Inside::above ? " above" : " below");
        enclosed += static_cast<std::size_t>(
            std::ranges::count_if(wanted.parent, [](std::uint32_t p) { return p != kNone; }));
        inward += static_cast<std::size_t>(std::ranges::count(wanted.facing, std::int8_t{-1}));
      }
    }
  }
  EXPECT_GT(enclosed, 20U);
  EXPECT_GT(inward, 20U);
}

}  // namespace
}  // namespace isoatlas::detail
