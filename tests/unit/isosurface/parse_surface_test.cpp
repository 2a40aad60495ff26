// SPDX-License-Identifier: Apache-2.0
// The topology of the parsed surface against known shapes, and against an independent way of
// counting.
#include "isosurface/parse_surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/parallel.h"
#include "isosurface/cell_loops.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

std::vector<TopologySummary::Kind> parsed_kinds(const SurfaceComplex& surface) {
  return count_manifold(surface).topology.kinds;
}

// The reference counts one disk per loop; tunnel_test.cpp checks the trilinear topology.
SurfaceComplex faces_surface_of(const Samples& samples, double isovalue,
                                Inside inside = Inside::above) {
  return surface_of(samples, isovalue, inside, {1, 1, 1}, Topology::faces);
}

void expect_like_reference(const Samples& samples, double isovalue, Inside inside,
                           const std::string& what) {
  const SurfaceComplex surface = faces_surface_of(samples, isovalue, inside);
  const TopologySummary want = reference_topology(samples, isovalue, inside);
  const TopologySummary got = count_manifold(surface).topology;
  ASSERT_EQ(got, want) << what << ": " << text(got.kinds) << "instead of " << text(want.kinds);
  // The faces, split into triangles, have the same topology.
  ASSERT_EQ(kinds_of(triangles_of(surface)), want.kinds) << what;
}

TEST(ReferenceTopology, CountsTheKnownShapes) {  // checks the reference itself first
  for (const KnownVolume& known : known_volumes()) {
    EXPECT_EQ(reference_topology(known.samples, known.isovalue).kinds, known.faces_kinds)
        << known.name << ": " << text(reference_topology(known.samples, known.isovalue).kinds);
  }
}

TEST(ParseSurface, KnownShapes) {
  for (const KnownVolume& known : known_volumes()) {
    const SurfaceComplex surface = surface_of(known.samples, known.isovalue);
    EXPECT_EQ(parsed_kinds(surface), known.kinds)
        << known.name << ": " << text(parsed_kinds(surface));
    EXPECT_EQ(parsed_kinds(faces_surface_of(known.samples, known.isovalue)), known.faces_kinds)
        << known.name;
  }
}

TEST(ParseSurface, EverySignPatternOfOneCell) {
  Random random(1);
  for (int pattern = 1; pattern < 255; ++pattern) {
    for (int round = 0; round < 12; ++round) {
      Samples s = constant({2, 2, 2}, 0);
      const std::int64_t largest = round < 4   ? 1
                                   : round < 8 ? 3
                                               : 1000;  // the first ones are all ties
      for (int c = 0; c < 8; ++c)
        s.values[c] = (pattern >> c & 1 ? 1 : -1) * random.between(1, largest);
      for (const Inside inside : {Inside::above, Inside::below}) {
        expect_like_reference(
            s, 0, inside, "pattern " + std::to_string(pattern) + " round " + std::to_string(round));
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(ParseSurface, EverySignPatternWithinALargerVolume) {
  Random random(2);
  for (int pattern = 1; pattern < 255; ++pattern) {
    for (const std::int64_t around : {-1, 1}) {
      Samples s = constant({4, 4, 4}, around);
      for (int c = 0; c < 8; ++c)
        s.at(1 + (c & 1), 1 + (c >> 1 & 1), 1 + (c >> 2)) =
            (pattern >> c & 1 ? 1 : -1) * random.between(1, 2);
      expect_like_reference(s, 0, Inside::above, "pattern " + std::to_string(pattern));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(ParseSurface, RandomVolumesAgainstTheReference) {
  Random random(3);
  for (std::uint64_t seed = 0; seed < 160; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    Size size;
    for (std::size_t& n : size)
      n = static_cast<std::size_t>(random.between(2, seed % 3 == 0 ? 3 : 9));
    const Samples s = random_samples(family, size, seed);
    for (const double isovalue : {0.0, -1.0, 0.5}) {
      for (const Inside inside : {Inside::above, Inside::below}) {
        if (!has_surface(s, isovalue, inside)) continue;
        expect_like_reference(s, isovalue, inside,
                              std::string(name(family)) + " seed " + std::to_string(seed));
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(ParseSurface, RowsLongerThanOneWordOfSignBits) {
  for (const std::size_t nx : {62u, 63u, 64u, 65u, 66u, 127u, 128u, 129u, 200u}) {
    for (const Family family : {Family::white_noise, Family::few_values, Family::sparse_specks}) {
      const Samples s = random_samples(family, {nx, 3, 3}, nx);
      if (!has_surface(s, 0)) continue;
      expect_like_reference(s, 0, Inside::above,
                            std::string(name(family)) + " " + std::to_string(nx));
      if (HasFatalFailure()) return;
    }
  }
}

// Inside::below is the same as negating samples and isovalue; and a surface does not depend on the
// names and directions of the axes.
TEST(ParseSurface, SymmetriesKeepTheTopology) {
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    const auto family = static_cast<Family>(seed % kFamilies);
    const Samples s = random_samples(family, {7, 6, 5}, seed + 1000);
    if (!has_surface(s, 0)) continue;
    const auto kinds = parsed_kinds(surface_of(s));
    const std::string what = std::string(name(family)) + " seed " + std::to_string(seed);
    EXPECT_EQ(parsed_kinds(surface_of(negated(s), 0, Inside::below)), kinds) << what;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(parsed_kinds(surface_of(mirrored(s, axis))), kinds) << what << " mirrored " << axis;
    for (const auto& order : {std::array{1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}}) {
      EXPECT_EQ(parsed_kinds(surface_of(permuted(s, order))), kinds) << what << " permuted";
    }
    for (const Vec3 spacing : {Vec3{1, 2, 3}, {0.01, 5, 0.3}}) {
      EXPECT_EQ(parsed_kinds(surface_of(s, 0, Inside::above, spacing)), kinds)
          << what << " spacing";
    }
  }
}

TEST(ParseSurface, BelowIsTheNegatedVolumePointForPoint) {
  const Samples s = random_samples(Family::gyroid_cut, {9, 8, 7}, 5);
  const SurfaceComplex below = surface_of(s, 3.5, Inside::below),
                       negative = surface_of(negated(s), -3.5);
  ASSERT_EQ(below.c_vertex_count(), negative.c_vertex_count());
  for (std::size_t i = 0; i < below.positions.size(); ++i)
    EXPECT_EQ(below.positions[i], negative.positions[i]);
  for (std::size_t i = 0; i < below.faces.size(); ++i)
    EXPECT_EQ(below.faces[i].corner, negative.faces[i].corner);
}

TEST(ParseSurface, EverySampleTypeGivesTheSameComplex) {
  Samples s = random_samples(Family::few_values, {7, 6, 8}, 77);
  const SurfaceComplex want = surface_of(s, 1);
  for (const SampleType type : kAllTypes) {
    const bool is_unsigned = name(type).starts_with("u");
    const Volume volume = to_volume(is_unsigned ? plus(s, 100) : s, type);
    ParseOptions options;
    options.rule.isovalue = is_unsigned ? 101 : 1;
    const SurfaceComplex got = parse_surface(volume, options);
    EXPECT_EQ(got.positions, want.positions) << name(type);
    ASSERT_EQ(got.faces.size(), want.faces.size()) << name(type);
    for (std::size_t i = 0; i < got.faces.size(); ++i)
      ASSERT_EQ(got.faces[i].corner, want.faces[i].corner) << name(type);
  }
}

// 2^53 and more: the samples differ where doubles do not, so faces must be decided on the samples
// themselves.
TEST(ParseSurface, Integers64AreDecidedExactly) {
  Random random(9);
  for (int round = 0; round < 40; ++round) {
    const Samples small =
        random_samples(Family::few_values, {4, 4, 4}, static_cast<std::uint64_t>(round));
    if (!has_surface(small, 0)) continue;
    Samples large = small;
    const std::int64_t base = std::int64_t{1} << 62;
    for (std::int64_t& v : large.values) v += base;
    ParseOptions options;
    options.rule.isovalue = static_cast<double>(base);
    options.topology = Topology::faces;
    const SurfaceComplex got = parse_surface(to_volume(large, SampleType::int64), options);
    EXPECT_EQ(validate(got), "");
    EXPECT_EQ(parsed_kinds(got), reference_topology(small, 0).kinds) << round;
  }
}

TEST(ParseSurface, SameBytesForAnyNumberOfThreads) {
  const Volume volume = to_volume(random_samples(Family::white_noise, {20, 21, 22}, 4));
  SurfaceComplex first;
  for (const int threads : {1, 2, 3, 5}) {
    const ThreadLimit limit(threads);
    const SurfaceComplex surface = parse_surface(volume, {});
    if (threads == 1) {
      first = surface;
      continue;
    }
    ASSERT_EQ(surface.positions, first.positions);
    ASSERT_EQ(surface.on_boundary, first.on_boundary);
    ASSERT_EQ(surface.faces.size(), first.faces.size());
    for (std::size_t i = 0; i < surface.faces.size(); ++i)
      ASSERT_EQ(surface.faces[i].corner, first.faces[i].corner);
    ASSERT_EQ(surface.boundary.size(), first.boundary.size());
    for (std::size_t i = 0; i < surface.boundary.size(); ++i) {
      ASSERT_EQ(surface.boundary[i].from, first.boundary[i].from);
      ASSERT_EQ(surface.boundary[i].to, first.boundary[i].to);
    }
  }
}

TEST(ParseSurface, NoSurface) {
  for (const std::int64_t value : {-1, 0, 1}) {
    const SurfaceComplex s = parse_surface(to_volume(constant({4, 3, 2}, value)), {});
    EXPECT_EQ(s.c_vertex_count(), 0u);
    EXPECT_TRUE(s.faces.empty());
    EXPECT_TRUE(s.boundary.empty());
  }
}

TEST(ParseSurface, DoubleSegmentsAreFoundAndSplit) {
  // Two diagonal inside samples on one face, joined there; both cells at the face have one loop
  // through all four nodes.
  Samples s = constant({4, 4, 4}, -8);
  s.at(1, 1, 1) = s.at(2, 2, 1) = 9;
  const SurfaceComplex surface = surface_of(s);
  EXPECT_EQ(surface.double_segments, 1u);
  EXPECT_EQ(parsed_kinds(surface), (std::vector<TopologySummary::Kind>{{0, 0, 1}}));
  // Smooth data have none.
  EXPECT_EQ(surface_of(sampled({20, 20, 20}, sphere({9.4, 9.6, 9.5}, 7))).double_segments, 0u);
}

TEST(ParseSurface, CancelledBeforehand) {
  const std::atomic<bool> cancel{true};
  RunControl control;
  control.cancel = &cancel;
  EXPECT_THROW(
      parse_surface(to_volume(random_samples(Family::white_noise, {8, 8, 8}, 1)), {}, control),
      Error);
}

// Follows the loops of every entry of the table again in a simple way: segments from sign changes
// on the six faces.
TEST(CellLoopTable, EveryEntryIsASetOfClosedLoops) {
  const CellLoopTable& table = CellLoopTable::get();
  int entries = 0;
  for (int corners = 0; corners < 256; ++corners) {
    const auto signs = static_cast<std::uint8_t>(corners);
    const std::uint8_t ambiguous = table.ambiguous_faces(signs);
    for (int joined = 0; joined < 64; ++joined) {
      if ((joined & ~ambiguous) != 0) continue;
      ++entries;
      const CellLoops& loops = table[table.index(signs, static_cast<std::uint8_t>(joined))];
      ASSERT_EQ(loops.corners, signs);
      ASSERT_EQ(loops.joined_faces, joined);
      ASSERT_EQ(loops.ambiguous_faces, ambiguous);
      ASSERT_LE(loops.loops, 4);
      std::array<int, 4> length{};
      for (int e = 0; e < 12; ++e) {
        const auto [low, high] = edge_corners(e);
        ASSERT_EQ(loops.crossed >> e & 1, (corners >> low & 1) != (corners >> high & 1));
        if (loops.crossed >> e & 1) {
          ASSERT_LT(loops.surfel_of_edge[e], loops.loops);
          ++length[loops.surfel_of_edge[e]];
        }
      }
      for (int k = 0; k < loops.loops; ++k) ASSERT_GE(length[k], 3);
      // On every face the segments join edges of one loop: each unambiguous face has 0 or 2 crossed
      // edges.
      for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
          if (ambiguous >> (2 * axis + side) & 1) continue;
          std::vector<int> on_face;
          for (int b = 0; b < 2; ++b) {
            for (const int e :
                 {face_edge_along_u(axis, side, b), face_edge_along_v(axis, side, b)}) {
              if (loops.crossed >> e & 1) on_face.push_back(loops.surfel_of_edge[e]);
            }
          }
          ASSERT_TRUE(on_face.empty() || (on_face.size() == 2 && on_face[0] == on_face[1]));
        }
      }
    }
  }
  const auto plain = std::count_if(table.entries().begin(), table.entries().end(),
                                   [](const CellLoops& c) { return !c.has_tunnel; });
  EXPECT_EQ(entries, plain);
}

}  // namespace
}  // namespace isoatlas::detail
