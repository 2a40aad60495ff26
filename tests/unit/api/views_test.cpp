// SPDX-License-Identifier: Apache-2.0
// The public API as a user has it: views of samples, options by default, fields and normals.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/vector_math.h"
#include "isoatlas/isoatlas.h"
#include "support/mesh_counts.h"
#include "support/volumes.h"

namespace isoatlas::test {
using namespace isoatlas::detail;
namespace {

std::vector<float> ball_samples(int nx, int ny, int nz) {
  std::vector<float> out;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        out.push_back(static_cast<float>(5.2 - std::hypot(x - 8.1, y - 7.3, z - 6.7)));
  return out;
}

bool same(const TriangleMesh& a, const TriangleMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles;
}

ErrorCode code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.code();
  }
  throw std::runtime_error("nothing was thrown");
}

TEST(View, EverySampleTypeHasItsName) {
  EXPECT_EQ(sample_type_of<std::int8_t>(), SampleType::int8);
  EXPECT_EQ(sample_type_of<std::uint8_t>(), SampleType::uint8);
  EXPECT_EQ(sample_type_of<short>(), SampleType::int16);
  EXPECT_EQ(sample_type_of<unsigned short>(), SampleType::uint16);
  EXPECT_EQ(sample_type_of<int>(), SampleType::int32);
  EXPECT_EQ(sample_type_of<unsigned>(), SampleType::uint32);
  EXPECT_EQ(sample_type_of<long long>(), SampleType::int64);
  EXPECT_EQ(sample_type_of<unsigned long>(), SampleType::uint64);
  EXPECT_EQ(sample_type_of<float>(), SampleType::float32);
  EXPECT_EQ(sample_type_of<double>(), SampleType::float64);
}

TEST(View, NeedsExactlyItsNumberOfSamples) {
  const std::vector<float> samples(24);
  EXPECT_NO_THROW(VolumeView::of(samples, {2, 3, 4}));
  EXPECT_EQ(code_of([&] { VolumeView::of(samples, {2, 3, 5}); }), ErrorCode::bad_argument);
  EXPECT_EQ(code_of([&] { VolumeView::of(samples, {2, 3, 3}); }), ErrorCode::bad_argument);
  EXPECT_EQ(code_of([&] { VolumeView::of(samples, {2, -3, 4}); }), ErrorCode::bad_argument);
  const std::span<const float> all(samples);
  EXPECT_NO_THROW(VolumeView::of(all, {2, 3, 2}, {1, 4, 12}));
  EXPECT_EQ(code_of([&] { VolumeView::of(all, {2, 3, 3}, {1, 4, 12}); }), ErrorCode::bad_argument);
}

// The same samples in other orders of memory, with gaps, and backwards.
TEST(View, SizesAreIntegersOfAnyType) {
  const int nx = 4;
  const long ny = 5;
  Grid grid;
  grid.size = {nx, ny, 6u};
  const auto [x, y, z] = grid.size;
  EXPECT_EQ((std::array{x, y, z}), (std::array<std::size_t, 3>{4, 5, 6}));
  try {
    grid.size = {nx, -3, nx};
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_argument);
    EXPECT_STREQ(error.what(), "a number of samples or an index is -3, expected 0 or more");
  }
}

TEST(View, StridesMakeNoDifference) {
  const int nx = 17, ny = 15, nz = 14;
  const std::vector<float> samples = ball_samples(nx, ny, nz);
  const TriangleMesh expected = extract(VolumeView::of(samples, {nx, ny, nz}), 0).mesh();
  const auto at = [&](int x, int y, int z) {
    return samples[static_cast<std::size_t>(x + nx * (y + ny * z))];
  };

  std::vector<float> z_fastest, padded(static_cast<std::size_t>((nx + 3) * ny * nz), 1e9F),
      backwards(samples.rbegin(), samples.rend());
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) z_fastest.push_back(at(x, y, z));
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        padded[static_cast<std::size_t>(x + (nx + 3) * (y + ny * z))] = at(x, y, z);

  const Size3 size{nx, ny, nz};
  for (const VolumeView& view :
       {VolumeView::of(std::span<const float>(z_fastest), size, {ny * nz, nz, 1}),
        VolumeView::of(std::span<const float>(padded), size, {1, nx + 3, (nx + 3) * ny}),
        VolumeView::of(std::span<const float>(backwards), size, {-1, -nx, -nx * ny})}) {
    EXPECT_FALSE(view.is_dense());
    EXPECT_TRUE(same(extract(view, 0).mesh(), expected));
    EXPECT_EQ(summarize(view).maximum, summarize(VolumeView::of(samples, size)).maximum);
    MeasureOptions options;
    options.samples = 500;
    EXPECT_LT(measure(expected, view, options).maximum(), 0.6);
  }
}

TEST(View, BoxIsThePartWithItsPlaceInTheWorld) {
  const std::vector<float> samples = ball_samples(17, 15, 14);
  VolumeView whole = VolumeView::of(samples, {17, 15, 14});
  whole.grid.spacing = {2, 0.5, 1};
  whole.grid.origin = {10, 20, 30};
  const VolumeView part = whole.box({2, 1, 1}, {14, 13, 12});
  EXPECT_EQ(part.grid.size, (std::array<std::size_t, 3>{13, 13, 12}));
  EXPECT_EQ(part.grid.origin, whole.grid.to_world({2, 1, 1}));
  EXPECT_EQ(detail::test::count_mesh(extract(part, 0).mesh()).topology.kinds,
            (std::vector<TopologySummary::Kind>{{0, 0, 1}}));  // the ball is inside
  for (const Vec3& p : extract(part, 0, {}).mesh().positions)
    EXPECT_NEAR(p.x, 10 + 2 * 8.1, 2 * 5.3);
  EXPECT_EQ(code_of([&] { whole.box({0, 0, 0}, {17, 14, 13}); }), ErrorCode::bad_argument);
  EXPECT_EQ(code_of([&] { whole.box({3, 0, 0}, {2, 14, 13}); }), ErrorCode::bad_argument);
  const VolumeView inner = part.box({1, 1, 1}, {5, 5, 5});  // of a view that has strides already
  EXPECT_EQ(inner.grid.origin, whole.grid.to_world({3, 2, 2}));
  EXPECT_EQ(summarize(inner).maximum, summarize(whole.box({3, 2, 2}, {7, 6, 6})).maximum);
}

TEST(Options, OneLevelWithinHalfAVoxelByDefault) {
  const std::vector<float> samples = ball_samples(17, 15, 14);
  VolumeView volume = VolumeView::of(samples, {17, 15, 14});
  volume.grid.spacing = {0.5, 0.5, 0.7};
  const Extraction e = extract(volume, 0);
  ASSERT_EQ(e.report.levels.size(), 2u);
  const ConstraintResult& result = e.finest().constraints.at(0);
  EXPECT_TRUE(result.constraint.is_default);
  EXPECT_EQ(result.constraint.bound, 0.25);
  EXPECT_TRUE(result.satisfied);
  EXPECT_EQ(extract(volume, ExtractOptions{}).report.levels.size(), 2u);

  volume.grid.spacing = {0.5, 0.5, 4};  // thick layers: an eighth of the largest
  EXPECT_EQ(extract(volume, 0).finest().constraints.at(0).constraint.bound, 0.5);
}

TEST(Options, LengthsAreInTheWorldOrInVoxels) {
  const std::vector<float> samples = ball_samples(17, 15, 14);
  VolumeView volume = VolumeView::of(samples, {17, 15, 14});
  volume.grid.spacing = {0.5, 0.5, 0.5};
  const Extraction world = extract(volume, 0, {within(0.1)}),
                   voxels = extract(volume, 0, {within(0.2 * vx)});
  EXPECT_TRUE(same(world.mesh(), voxels.mesh()));
  EXPECT_EQ(voxels.finest().constraints.at(0).constraint.bound, 0.1);
  EXPECT_FALSE(voxels.finest().constraints.at(0).constraint.in_voxels);
  ExtractOptions options;
  options.refine = {{within(1 * vx), bounded(Quantity::max_edge, 3 * vx)}, within(0.2 * vx)};
  options.covering.max_radius = 4 * vx;
  const Extraction both = extract(volume, options);
  ASSERT_EQ(both.report.levels.size(), 3u);
  EXPECT_EQ(both.report.levels[1].constraints.at(1).constraint.bound, 1.5);
  EXPECT_EQ(code_of([&] { extract(volume, 0, {bounded(Quantity::max_vertices, 100 * vx)}); }),
            ErrorCode::bad_argument);
}

TEST(Field, IsSampledOverABoxForAnyNumberOfThreads) {
  const ScalarField field([](Vec3 p) { return 1 - std::hypot(p.x, p.y, p.z); });
  RunControl one, two;
  one.threads = 1;
  two.threads = 2;
  const Volume a = sample(field, {-1.5, -1.5, -1.5}, {1.5, 1.5, 1.2}, 0.1, one),
               b = sample(field, {-1.5, -1.5, -1.5}, {1.5, 1.5, 1.2}, 0.1, two);
  ASSERT_EQ(a.view.grid.size, (std::array<std::size_t, 3>{31, 31, 28}));
  EXPECT_EQ(a.view.grid.origin, (Vec3{-1.5, -1.5, -1.5}));
  const auto* x = static_cast<const double*>(a.view.samples);
  const auto* y = static_cast<const double*>(b.view.samples);
  EXPECT_TRUE(std::equal(x, x + a.view.grid.sample_count(), y));
  EXPECT_NEAR(x[30 + 31 * (30 + 31 * 27)], 1 - std::hypot(1.5, 1.5, 1.2), 1e-12);
  const Extraction e = extract(a, 0, {within(0.02)});
  EXPECT_EQ(detail::test::count_mesh(e.mesh()).topology.kinds,
            (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
  for (const Vec3& p : e.mesh().positions) EXPECT_NEAR(length(p), 1, 0.01);
  EXPECT_EQ(code_of([&] { sample(field, {0, 0, 0}, {1, 1, 0}, 0.1); }), ErrorCode::bad_argument);
  EXPECT_EQ(code_of([&] { sample(field, {0, 0, 0}, {1, 1, 1}, 0); }), ErrorCode::bad_argument);
  EXPECT_THROW(
      sample([](Vec3) -> double { throw std::logic_error("mine"); }, {0, 0, 0}, {1, 1, 1}, 0.5),
      std::logic_error);
}

// Of a ball on rotated, mirrored and anisotropic grids, in all spaces.
TEST(Normals, PointOutwardWhateverTheGrid) {
  const double c = std::cos(0.5), s = std::sin(0.5);
  const std::array<std::array<Vec3, 3>, 3> directions{
      {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}},
       {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}},
       {Vec3{c, 0, s}, Vec3{0, -1, 0}, Vec3{-s, 0, c}}}};
  for (const auto& direction : directions) {
    Grid grid;
    grid.size = {40, 40, 30};
    grid.spacing = {0.1, 0.1, 0.15};
    grid.direction = direction;
    const Vec3 centre = grid.to_world({19.6, 19.3, 14.7});
    for (const Inside inside : {Inside::above, Inside::below}) {
      const double sign = inside == Inside::above ? 1 : -1;
      const ScalarField ball([&](Vec3 p) { return sign * (1.4 - length(p - centre)); },
                             [&](Vec3 p) { return (-sign / length(p - centre)) * (p - centre); });
      const Volume volume = sample(ball, grid);
      for (const Space space : {Space::lps, Space::ras, Space::voxel}) {
        ExtractOptions options;
        options.surface.inside = inside;
        options.space = space;
        const TriangleMesh mesh = extract(volume, options).mesh();
        const std::vector<Vec3> flat = vertex_normals(mesh),
                                smooth = vertex_normals(mesh, volume, options.surface, space);
        ASSERT_EQ(flat.size(), mesh.positions.size());
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
          Vec3 outward = mesh.positions[v];
          if (space == Space::ras) outward = {-outward.x, -outward.y, outward.z};
          if (space == Space::voxel) {
            const Vec3 d = mesh.positions[v] - Vec3{19.6, 19.3, 14.7};
            outward =
                normalized(Vec3{d.x * 0.01, d.y * 0.01,
                                d.z * 0.0225});  // the gradient of the squared distance, per step
          } else {
            outward = normalized(outward - centre);
            if (space == Space::ras) outward = {-outward.x, -outward.y, outward.z};
          }
          EXPECT_GT(dot(flat[v], outward), std::cos(30 * std::numbers::pi / 180));
          EXPECT_GT(dot(smooth[v], outward), std::cos(5 * std::numbers::pi / 180));
        }
        if (space != Space::lps) continue;
        const std::vector<Vec3> exact = vertex_normals(mesh, ball, inside);
        for (std::size_t v = 0; v < mesh.positions.size(); ++v)
          EXPECT_GT(dot(exact[v], normalized(mesh.positions[v] - centre)), 0.9999999);
      }
    }
  }
  EXPECT_EQ(code_of([] {
              vertex_normals(TriangleMesh{{{0, 0, 0}}, {{0, 0, 1}}});
            }),
            ErrorCode::bad_argument);
}

TEST(Mesh, ViewsOfLevelsAreTheirMeshes) {
  const std::vector<float> samples = ball_samples(17, 15, 14);
  for (const Placement placement : {Placement::surface, Placement::balanced}) {
    ExtractOptions options;
    options.placement = placement;
    const Extraction e = extract(VolumeView::of(samples, {17, 15, 14}), options);
    for (std::size_t k = 0; k < e.hierarchy.levels.size(); ++k) {
      const TriangleMesh mesh = e.hierarchy.mesh(k);
      const MeshView view = e.hierarchy.view(k);
      EXPECT_TRUE(std::ranges::equal(view.positions, mesh.positions));
      EXPECT_TRUE(std::ranges::equal(view.triangles, mesh.triangles));
      EXPECT_EQ(mesh_topology(view).components, detail::test::count_mesh(mesh).components);
    }
  }
}

TEST(Errors, RefuseANegativeNumberOfThreads) {
  const Volume ball = sample([](Vec3 p) { return 1 - length(p); }, {-2, -2, -2}, {2, 2, 2}, 0.5);
  RunControl control;
  control.threads = -1;
  try {
    extract(ball, {}, control);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_argument);
    EXPECT_STREQ(error.what(), "the number of threads is -1, expected 0 (all processors) or more");
  }
}

TEST(Errors, NameTheRemedyInTheWordsOfTheLibrary) {
  std::vector<float> samples = ball_samples(17, 15, 14);
  samples[5] = std::nanf("");
  try {
    extract(VolumeView::of(samples, {17, 15, 14}), 0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.remedy(), Remedy::place_nan);
    EXPECT_NE(std::string(error.what()).find("SurfaceOptions::non_finite"), std::string::npos);
    EXPECT_EQ(error.problem().find("SurfaceOptions"), std::string::npos);
    EXPECT_EQ(error.with_prefix("a.nrrd: ").what(), "a.nrrd: " + std::string(error.what()));
  }
}

}  // namespace
}  // namespace isoatlas::test
