// SPDX-License-Identifier: Apache-2.0
// component_extents() against closed forms and exact arithmetic.
#include "isoatlas/component_extents.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>

#include "isoatlas/error.h"
#include "support/surfaces.h"
#include "support/volumes.h"

namespace isoatlas::detail {
namespace {

using namespace test;

// A box of 12 triangles that face outwards.
TriangleMesh box(Vec3 low, Vec3 high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(
        {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh inverted(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh out = a;
  const auto n = static_cast<std::uint32_t>(a.positions.size());
  out.positions.insert(out.positions.end(), b.positions.begin(), b.positions.end());
  for (const Triangle& t : b.triangles) out.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return out;
}

TEST(ComponentExtents, OfABox) {
  const auto extents = component_extents(box({1, 2, 3}, {3, 5, 7}));
  ASSERT_EQ(extents.size(), 1u);
  EXPECT_EQ(extents[0].component, 0u);
  EXPECT_EQ(extents[0].triangles, 12u);
  EXPECT_EQ(extents[0].bounds, (BoundingBox{{1, 2, 3}, {3, 5, 7}}));
  EXPECT_EQ(extents[0].area, 2 * (6 + 8 + 12));
  EXPECT_EQ(extents[0].volume, 24);
  EXPECT_EQ(extents[0].topology, (ComponentTopology{2, 0}));
}

TEST(ComponentExtents, NothingOfAnEmptyMesh) {
  EXPECT_TRUE(component_extents(TriangleMesh{}).empty());
  EXPECT_EQ(summarize(std::vector<ComponentExtent>{}), MeshExtent{});
  const MeshExtent unused = summarize(component_extents(TriangleMesh{{{7, 7, 7}}, {}}));
  EXPECT_EQ(unused, MeshExtent{}) << "vertices in no triangle do not count";
}

// A shell: the inner box faces inwards.
TEST(ComponentExtents, ACavityIsNegativeAndSubtracted) {
  const TriangleMesh shell =
      together(box({0, 0, 0}, {10, 10, 10}), inverted(box({4, 4, 4}, {6, 6, 6})));
  const auto extents = component_extents(shell);
  ASSERT_EQ(extents.size(), 2u);
  EXPECT_EQ(extents[0].volume, 1000);
  EXPECT_EQ(extents[1].volume, -8);
  const MeshExtent all = summarize(extents);
  EXPECT_EQ(all.volume, 992);
  EXPECT_EQ(all.area, 624);
  EXPECT_EQ(all.bounds, (BoundingBox{{0, 0, 0}, {10, 10, 10}}));
  EXPECT_EQ(all.components, 2u);
  EXPECT_EQ(all.open_components, 0u);
}

TEST(ComponentExtents, AnOpenComponentEnclosesNothing) {
  TriangleMesh open = box({0, 0, 0}, {2, 2, 2});
  open.triangles.pop_back();
  const MeshExtent alone = summarize(component_extents(open));
  EXPECT_FALSE(alone.volume);
  EXPECT_EQ(alone.open_components, 1u);
  EXPECT_EQ(alone.area, 22);
  EXPECT_EQ(alone.largest.front().topology.boundary_loops, 1);
  const MeshExtent both = summarize(component_extents(together(open, box({5, 5, 5}, {6, 6, 6}))));
  EXPECT_EQ(both.volume, 1) << "that of the closed component";
  EXPECT_EQ(both.open_components, 1u);
}

// Two boxes that share an edge: that edge has four triangles, but the volume is defined.
TEST(ComponentExtents, OfANonManifoldMeshWhoseOrientationsCancel) {
  TriangleMesh mesh = together(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {3, 3, 1}));
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) {
      if (v == 8) v = 3;   // (1, 1, 0)
      if (v == 12) v = 7;  // (1, 1, 1)
    }
  }
  ASSERT_FALSE(mesh_topology(mesh).is_manifold());
  const auto extents = component_extents(mesh);
  ASSERT_EQ(extents.size(), 1u);
  EXPECT_EQ(extents[0].volume, 5);
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  EXPECT_FALSE(component_extents(mesh)[0].volume) << "one triangle is inverted";
}

TEST(ComponentExtents, AnInvertedTriangleLeavesNoVolume) {
  TriangleMesh mesh = together(box({0, 0, 0}, {1, 1, 1}), box({4, 4, 4}, {6, 6, 6}));
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  const auto extents = component_extents(mesh);
  EXPECT_FALSE(extents[0].volume);
  EXPECT_EQ(extents[1].volume, 8) << "the other component is not affected";
}

TEST(ComponentExtents, DegenerateTrianglesAddNothing) {
  TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back({2, 2, 5});
  mesh.triangles.push_back({3, 3, 3});
  const auto extents = component_extents(mesh);
  EXPECT_EQ(extents[0].volume, 1);
  EXPECT_EQ(extents[0].area, 6);
}

// Positions in nanometres, in metres far away, and at the limits of a double.
TEST(ComponentExtents, ScaleAndDistanceCostNoDigits) {
  for (const double unit : {1e-80, 1e-9, 1.0, 1e12, 1e90}) {
    const auto extents = component_extents(box({0, 0, 0}, {2 * unit, 3 * unit, 4 * unit}));
    EXPECT_NEAR(extents[0].area / (unit * unit), 52, 1e-13) << unit;
    EXPECT_NEAR(*extents[0].volume / unit / unit / unit, 24, 1e-13) << unit;
  }
  const double far = 0x1p40;
  const auto extents = component_extents(box({far, far, -far}, {far + 1, far + 1, 1 - far}));
  EXPECT_EQ(extents[0].volume, 1);
  EXPECT_EQ(extents[0].area, 6);
}

// The volume of a rough surface, in exact arithmetic: its vertices are whole numbers.
TEST(ComponentExtents, EqualsTheExactVolume) {
  Random random(7);
  TriangleMesh mesh =
      triangles_of(surface_of(sampled({40, 40, 40}, [&](double x, double y, double z) {
        return 15 + 3 * random.unit() - std::hypot(std::hypot(x - 19.6, y - 19.4), z - 19.5);
      })));
  for (Vec3& p : mesh.positions)
    p = {std::round(1e6 * p.x), std::round(1e6 * p.y), std::round(1e6 * p.z)};
  using boost::multiprecision::cpp_int;
  cpp_int six_volumes = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](int k) {
      const Vec3 p = mesh.positions[t[k]];
      return std::array<cpp_int, 3>{static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y),
                                    static_cast<std::int64_t>(p.z)};
    };
    const auto a = at(0), b = at(1), c = at(2);
    six_volumes += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  const double exact = static_cast<double>(six_volumes) / 6;
  const MeshExtent extent = summarize(component_extents(mesh));
  ASSERT_TRUE(extent.volume);
  EXPECT_NEAR(*extent.volume / exact, 1, 1e-15);
  for (Vec3& p : mesh.positions) p = {p.x + 0x1p50, p.y - 0x1p49, p.z + 0x1p50};  // exact
  EXPECT_EQ(summarize(component_extents(mesh)).volume, extent.volume) << "far from the origin";
}

TEST(ComponentExtents, ManyTrianglesCostNoDigits) {
  TriangleMesh flat;  // a strip of a million triangles of area 0.1 between two small ones
  constexpr std::uint32_t kColumns = 500'000;
  for (std::uint32_t i = 0; i <= kColumns; ++i) {
    flat.positions.push_back({static_cast<double>(i), 0, 0});
    flat.positions.push_back({static_cast<double>(i), 0.2, 0});
  }
  for (std::uint32_t i = 0; i < kColumns; ++i) {
    flat.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    flat.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  EXPECT_NEAR(component_extents(flat)[0].area / (0.2 * kColumns), 1, 4e-16);
}

TEST(ComponentExtents, TheLargestAreListedFirst) {
  TriangleMesh mesh;
  for (const int side : {2, 5, 1, 5, 3}) {
    const double at = 10.0 * static_cast<double>(mesh.positions.size());
    mesh = together(mesh, box({at, 0, 0}, {at + side, 1.0 * side, 1.0 * side}));
  }
  const MeshExtent extent = summarize(component_extents(mesh), 3);
  std::vector<std::uint32_t> order;
  for (const ComponentExtent& component : extent.largest) order.push_back(component.component);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{1, 3, 4}));
  EXPECT_EQ(extent.volume, 8 + 125 + 1 + 125 + 27) << "sums include components that are not listed";
  EXPECT_EQ(extent.components, 5u);
  EXPECT_TRUE(summarize(component_extents(mesh), 0).largest.empty());
}

TEST(ComponentExtents, PositionsThatAreNoNumbersEndInNoNumber) {
  TriangleMesh mesh = together(box({0, 0, 0}, {1, 1, 1}), box({4, 4, 4}, {6, 6, 6}));
  mesh.positions[0].x = std::numeric_limits<double>::quiet_NaN();
  mesh.positions[9].y = std::numeric_limits<double>::infinity();
  const MeshExtent extent = summarize(component_extents(mesh));
  EXPECT_EQ(extent.largest.size(), 2u);
  EXPECT_FALSE(std::isfinite(*extent.volume));
}

TEST(ComponentExtents, RefusesATopologyOfAnotherMesh) {
  const TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1});
  TriangleMesh other = mesh;
  other.triangles.pop_back();
  EXPECT_THROW(component_extents(mesh, mesh_topology(other)), Error);
  other = mesh;
  other.triangles[3][1] = 8;
  EXPECT_THROW(component_extents(other), Error) << "there is no vertex 8";
}

TEST(ComponentExtents, CanBeCancelled) {
  RunControl control;
  const std::atomic<bool> stop = true;
  control.cancel = &stop;
  EXPECT_THROW(component_extents(box({0, 0, 0}, {1, 1, 1}), control), Error);
}

}  // namespace
}  // namespace isoatlas::detail
