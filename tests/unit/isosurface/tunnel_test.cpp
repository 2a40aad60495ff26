// SPDX-License-Identifier: Apache-2.0
// Tunnels of the trilinear interpolant: decisions on single cells against brute force, and surfaces
// of whole volumes against the same volumes on a finer grid.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "core/saddle_sign.h"
#include "isosurface/cell_loops.h"
#include "isosurface/contains_tunnel.h"
#include "isosurface/parse_surface.h"
#include "support/reference_topology.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

using Cell = std::array<std::int64_t, 8>;
using Classes = std::array<int, 8>;  // per corner, the smallest corner connected with it

// ---- the program's decision for a cell, isovalue 0

struct Decision {
  const CellLoops* plain;
  const Tunnel* tunnel = nullptr;
};

// A long double of x87 as its double and the rest.
ExactSample exact(long double x) {
  const auto high = static_cast<double>(x);
  return {high, static_cast<double>(x - high)};
}

template <class Value>
Decision decide(const std::array<Value, 8>& f, long double isovalue = 0) {
  const CellLoopTable& table = CellLoopTable::get();
  std::array<ExactSample, 8> samples;
  unsigned corners = 0, joined = 0;
  for (int c = 0; c < 8; ++c) {
    samples[c] = f[c];
    if (static_cast<long double>(f[c]) >= isovalue) corners |= 1u << c;
  }
  const auto signs = static_cast<std::uint8_t>(corners);
  for (int face = 0; face < 6; ++face) {
    const auto at = [&](int bu, int bv) { return face_corner(face / 2, face % 2, bu, bv); };
    const int sign = saddle_sign(samples[at(0, 0)], samples[at(1, 1)], samples[at(1, 0)],
                                 samples[at(0, 1)], exact(isovalue));
    if ((corners >> at(0, 0) & 1) ? sign >= 0 : sign <= 0) joined |= 1u << face;
  }
  const std::uint16_t index = table.index(signs, static_cast<std::uint8_t>(joined));
  Decision out{&table[index], nullptr};
  for (const Tunnel& t : table.tunnels(index)) {
    if (!contains_tunnel(t, samples, exact(isovalue))) continue;
    EXPECT_EQ(out.tunnel, nullptr) << "two tunnels in one cell";
    out.tunnel = &t;
  }
  return out;
}

void join(Classes& classes, int a, int b) {
  const int from = std::max(classes[a], classes[b]), to = std::min(classes[a], classes[b]);
  std::replace(classes.begin(), classes.end(), from, to);
}

Classes connected_corners(const Decision& decision) {
  const CellLoops& cell = *decision.plain;
  Classes out;
  std::iota(out.begin(), out.end(), 0);
  for (int e = 0; e < 12; ++e) {
    if (!(cell.crossed >> e & 1)) join(out, edge_corners(e)[0], edge_corners(e)[1]);
  }
  for (int face = 0; face < 6; ++face) {
    if (!(cell.ambiguous_faces >> face & 1)) continue;
    for (int bu = 0; bu < 2; ++bu) {
      const int a = face_corner(face / 2, face % 2, bu, 0),
                b = face_corner(face / 2, face % 2, 1 - bu, 1);
      if ((cell.corners >> a & 1) == (cell.joined_faces >> face & 1)) join(out, a, b);
    }
  }
  if (decision.tunnel != nullptr) {
    const auto corner = [&](int vertical) {
      return (cell.corners >> vertical & 1) == decision.tunnel->inside ? vertical : vertical + 4;
    };
    join(out, corner(decision.tunnel->joined[0]), corner(decision.tunnel->joined[1]));
  }
  return out;
}

std::vector<TopologySummary::Kind> kinds_in_cell(const Decision& decision) {
  const std::size_t loops = decision.plain->loops;
  std::vector<TopologySummary::Kind> out;
  const std::size_t disks = decision.tunnel ? loops - 2 : loops;
  if (disks > 0) out.push_back({0, 1, disks});
  if (decision.tunnel) out.push_back({0, 2, 1});
  return out;
}

// ---- brute force: the same function on a grid n times as fine, in whole numbers

Samples refined(const Samples& s, std::int64_t n) {
  const auto count = static_cast<std::size_t>(n);
  Samples out = constant(
      {(s.size[0] - 1) * count + 1, (s.size[1] - 1) * count + 1, (s.size[2] - 1) * count + 1}, 0);
  for (std::size_t z = 0; z < out.size[2]; ++z) {
    for (std::size_t y = 0; y < out.size[1]; ++y) {
      for (std::size_t x = 0; x < out.size[0]; ++x) {
        const std::array<std::size_t, 3> p{x, y, z};
        std::array<std::size_t, 3> low;
        std::array<std::int64_t, 3> t;
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(p[a] / count, s.size[a] - 2);
          t[a] = static_cast<std::int64_t>(p[a] - count * low[a]);
        }
        std::int64_t sum = 0;
        for (std::size_t c = 0; c < 8; ++c) {
          std::int64_t weight = 1;
          for (std::size_t a = 0; a < 3; ++a) weight *= (c >> a & 1) ? t[a] : n - t[a];
          if (weight != 0)
            sum += weight * s.at(low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2));
        }
        out.at(x, y, z) = sum;
      }
    }
  }
  return out;
}

// If the function is monotone on a cell's edges along one axis, the surface there is a graph over
// the other two axes: one disk per loop, with any decision about tunnels. If all crossed cells are
// like that, counting loops gives the topology of the trilinear surface.
bool loops_determine_the_topology(const Samples& s) {
  for (std::size_t z = 0; z + 1 < s.size[2]; ++z) {
    for (std::size_t y = 0; y + 1 < s.size[1]; ++y) {
      for (std::size_t x = 0; x + 1 < s.size[0]; ++x) {
        Cell f;
        int inside = 0;
        for (std::size_t c = 0; c < 8; ++c) {
          f[c] = s.at(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
          inside += f[c] >= 0;
        }
        if (inside == 0 || inside == 8) continue;
        bool monotone = false;
        for (int axis = 0; axis < 3; ++axis) {
          int rising = 0, falling = 0;
          for (int e = 4 * axis; e < 4 * axis + 4; ++e) {
            const auto [low, high] = edge_corners(e);
            rising += f[high] > f[low];
            falling += f[high] < f[low];
          }
          monotone |= rising == 4 || falling == 4;
        }
        if (!monotone) return false;
      }
    }
  }
  return true;
}

Classes connected_corners(const Samples& s) {
  std::vector<std::size_t> parent(s.values.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const std::array<std::size_t, 3> stride{1, s.size[0], s.size[0] * s.size[1]};
  const auto at = [&](std::size_t i) { return static_cast<long double>(s.values[i]); };
  for (std::size_t z = 0; z < s.size[2]; ++z) {
    for (std::size_t y = 0; y < s.size[1]; ++y) {
      for (std::size_t x = 0; x < s.size[0]; ++x) {
        const std::array<std::size_t, 3> p{x, y, z};
        const std::size_t i = x + stride[1] * y + stride[2] * z;
        for (std::size_t u = 0; u < 3; ++u) {
          if (p[u] + 1 == s.size[u]) continue;
          const std::size_t iu = i + stride[u];
          if ((s.values[i] >= 0) == (s.values[iu] >= 0)) parent[find(i)] = find(iu);
          for (std::size_t v = u + 1; v < 3; ++v) {
            if (p[v] + 1 == s.size[v]) continue;
            const std::size_t iv = i + stride[v], iuv = iu + stride[v];
            const bool a = s.values[i] >= 0, b = s.values[iu] >= 0;
            if (a == b || a != (s.values[iuv] >= 0) || b != (s.values[iv] >= 0)) continue;
            // The saddle has the sign of the determinant if i is inside, else the other one; 0 is
            // inside.
            const int sign = (a ? 1 : -1) * saddle_sign(at(i), at(iuv), at(iu), at(iv), 0);
            if ((sign >= 0) == a) {
              parent[find(i)] = find(iuv);
            } else {
              parent[find(iu)] = find(iv);
            }
          }
        }
      }
    }
  }
  std::array<std::size_t, 8> corner;
  for (std::size_t c = 0; c < 8; ++c) {
    corner[c] = find((c & 1 ? s.size[0] - 1 : 0) + stride[1] * (c >> 1 & 1 ? s.size[1] - 1 : 0) +
                     stride[2] * (c >> 2 ? s.size[2] - 1 : 0));
  }
  Classes out;
  for (int c = 0; c < 8; ++c)
    out[c] = static_cast<int>(std::find(corner.begin(), corner.end(), corner[c]) - corner.begin());
  return out;
}

Samples volume_of(const Cell& f) {
  Samples s = constant({2, 2, 2}, 0);
  std::copy(f.begin(), f.end(), s.values.begin());
  return s;
}

std::string text_of(const Cell& f) {
  std::string out;
  for (const std::int64_t v : f) out += std::to_string(v) + " ";
  return out;
}

// A cell with these signs. In some rounds magnitudes are of very different sizes, so that saddles
// are anywhere.
Cell random_cell(Random& random, int pattern, int round) {
  Cell f;
  for (int c = 0; c < 8; ++c) {
    const std::int64_t size = round % 3 == 0 ? random.between(1, 1000)
                              : round % 3 == 1
                                  ? static_cast<std::int64_t>(std::exp2(10 * random.unit()))
                                  : random.between(1, 12);
    f[c] = (pattern >> c & 1) ? size : -size;
  }
  return f;
}

std::vector<int> patterns_with_tunnels() {
  std::vector<int> out;
  const CellLoopTable& table = CellLoopTable::get();
  std::set<int> seen;
  for (std::size_t i = 0; i < table.entries().size() && !table.entries()[i].has_tunnel; ++i) {
    if (!table.tunnels(static_cast<std::uint16_t>(i)).empty())
      seen.insert(table.entries()[i].corners);
  }
  out.assign(seen.begin(), seen.end());
  return out;
}

std::size_t plain_entries() {
  const auto& entries = CellLoopTable::get().entries();
  return static_cast<std::size_t>(std::count_if(entries.begin(), entries.end(),
                                                [](const CellLoops& c) { return !c.has_tunnel; }));
}

std::vector<TopologySummary::Kind> parsed_kinds(const Samples& s) {  // one disk per loop
  ParseOptions options;
  options.topology = Topology::faces;
  return count_manifold(parse_surface(to_volume(s), options)).topology.kinds;
}

struct Tally {
  int cells = 0, tunnels = 0, skipped = 0;
};

void against_brute_force(const Cell& f, Tally& tally) {
  const Decision decision = decide(f);
  const Samples coarse = volume_of(f);
  ++tally.cells;
  tally.tunnels += decision.tunnel != nullptr;
  for (const std::int64_t n : {1, 2, 4, 8, 16, 32, 64}) {
    const Samples fine = refined(coarse, n);
    if (!loops_determine_the_topology(fine)) continue;
    ASSERT_EQ(connected_corners(decision), connected_corners(fine))
        << text_of(f) << "on a grid of " << n;
    // The components of the surface. On the finer grids the parser's count of loops, which other
    // tests check, is faster.
    const auto want = n <= 2 ? reference_topology(fine, 0).kinds : parsed_kinds(fine);
    ASSERT_EQ(text(kinds_in_cell(decision)), text(want)) << text_of(f) << "on a grid of " << n;
    return;
  }
  ++tally.skipped;
}

TEST(Tunnel, RandomCellsAgainstBruteForce) {
  Random random(11);
  Tally all;
  for (int i = 0; i < 10000; ++i) {
    against_brute_force(random_cell(random, 1 + i % 254, i / 254), all);
    if (HasFatalFailure()) return;
  }
  // Half of the patterns are those with tunnels.
  const std::vector<int> patterns = patterns_with_tunnels();
  const auto count = static_cast<int>(patterns.size());
  for (int i = 0; i < 10000; ++i) {
    against_brute_force(random_cell(random, patterns[i % count], i / count), all);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(all.cells, 20000);
  EXPECT_GT(all.tunnels, 200);
  EXPECT_LT(all.skipped, 100);
  RecordProperty("tunnels", all.tunnels);
  RecordProperty("skipped", all.skipped);
  std::printf("%d cells, %d of them with a tunnel, %d undecided by brute force\n", all.cells,
              all.tunnels, all.skipped);
}

// ---- symmetries

// Corner c of the result is corner image[c] of the cell.
std::vector<std::array<int, 8>> symmetries_of_the_cube() {
  std::vector<std::array<int, 8>> out;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int mirrored = 0; mirrored < 8; ++mirrored) {
      std::array<int, 8> image;
      for (int c = 0; c < 8; ++c) {
        int d = 0;
        for (int a = 0; a < 3; ++a) d |= ((c >> a & 1) ^ (mirrored >> a & 1)) << axes[a];
        image[c] = d;
      }
      out.push_back(image);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return out;
}

void same_for_all_symmetries(const Cell& f, int& tunnels) {
  const Decision decision = decide(f);
  const Classes classes = connected_corners(decision);
  tunnels += decision.tunnel != nullptr;
  static const auto symmetries = symmetries_of_the_cube();
  for (const auto& image : symmetries) {
    Cell g;
    for (int c = 0; c < 8; ++c) g[c] = f[image[c]];
    const Decision other = decide(g);
    ASSERT_EQ(decision.tunnel != nullptr, other.tunnel != nullptr) << text_of(f);
    if (decision.tunnel == nullptr) continue;
    ASSERT_EQ(decision.tunnel->inside, other.tunnel->inside) << text_of(f);
    const Classes turned = connected_corners(other);
    for (int c = 0; c < 8; ++c) {
      for (int d = 0; d < c; ++d)
        ASSERT_EQ(classes[image[c]] == classes[image[d]], turned[c] == turned[d]) << text_of(f);
    }
  }
}

TEST(Tunnel, TiesAreTheSameForAllSymmetries) {
  ASSERT_EQ(symmetries_of_the_cube().size(), 48u);
  Random random(12);
  int tunnels = 0;
  for (int i = 0; i < 100000; ++i) {
    Cell f;
    for (std::int64_t& v : f) v = random.between(-2, 2);
    same_for_all_symmetries(f, tunnels);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(tunnels, 100);
  std::printf("%d of 100000 cells have a tunnel\n", tunnels);
}

TEST(Tunnel, RandomCellsAreTheSameForAllSymmetries) {
  Random random(13);
  const std::vector<int> patterns = patterns_with_tunnels();
  int tunnels = 0;
  for (int i = 0; i < 20000; ++i) {
    same_for_all_symmetries(
        random_cell(random, patterns[i % patterns.size()], i / static_cast<int>(patterns.size())),
        tunnels);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(tunnels, 100);
}

// Equal counts as inside: the same as at an isovalue that is lower by an insignificant amount.
TEST(Tunnel, TiesEqualASlightlyLowerIsovalue) {
  Random random(14);
  int tunnels = 0, zeros = 0;
  for (int i = 0; i < 100000; ++i) {
    Cell f, g;
    bool zero = false;
    for (int c = 0; c < 8; ++c) {
      f[c] = random.between(-2, 2);
      g[c] = 1000000 * f[c] + 1;
      zero |= f[c] == 0;
    }
    const Decision tied = decide(f), untied = decide(g);
    ASSERT_EQ(tied.plain, untied.plain) << text_of(f);
    ASSERT_EQ(tied.tunnel, untied.tunnel) << text_of(f);
    tunnels += tied.tunnel != nullptr;
    zeros += tied.tunnel != nullptr && zero;
  }
  EXPECT_GT(tunnels, 100);
  EXPECT_GT(zeros, 10);
}

// Two opposite corners of 3 among corners of -1: the saddle in the middle of the cell is 0 exactly.
TEST(Tunnel, ANeckOfZeroWidthIsInside) {
  const auto is_there = [](double corner, double others, double isovalue) {
    std::array<double, 8> f;
    f.fill(others + isovalue);
    f[0] = f[7] = corner + isovalue;
    return decide(f, isovalue).tunnel != nullptr;
  };
  for (const double scale : {1.0, 0x1p-1070, 0x1p-500, 0x1p500, 0x1p1020}) {
    EXPECT_TRUE(is_there(3 * scale, -scale, 0)) << scale;
    EXPECT_FALSE(is_there(-3 * scale, scale, 0)) << scale;
    const double much = 1e308 * 1.7, least = 0x1p-1074;
    const double less = std::max(std::nextafter(3 * scale, 0), 3 * scale - much),
                 more = std::max(std::nextafter(3 * scale, much), least);
    EXPECT_FALSE(is_there(less, -scale, 0)) << scale;
    EXPECT_TRUE(is_there(more, -scale, 0)) << scale;
    EXPECT_FALSE(is_there(-less, scale, 0)) << scale;
    EXPECT_TRUE(is_there(-more, scale, 0)) << scale;
  }
  EXPECT_TRUE(is_there(3, -1, 0x1p50));
  EXPECT_FALSE(is_there(-3, 1, 0x1p50));
}

TEST(Tunnel, ScalesAndOffsetsDoNotMatter) {
  Random random(15);
  const std::vector<int> patterns = patterns_with_tunnels();
  int tested = 0;
  for (int i = 0; i < 40000 && tested < 50; ++i) {
    const Cell f = random_cell(random, patterns[i % patterns.size()], 2);
    const Decision decision = decide(f);
    if (decision.tunnel == nullptr) continue;
    for (const int exponent : {-1070, -500, 500, 1010}) {
      std::array<double, 8> scaled;
      for (int c = 0; c < 8; ++c) scaled[c] = std::ldexp(static_cast<double>(f[c]), exponent);
      ASSERT_EQ(decide(scaled).tunnel, decision.tunnel) << text_of(f) << "times 2^" << exponent;
    }
    Cell large;  // 64-bit integers that are equal as doubles
    for (int c = 0; c < 8; ++c) large[c] = f[c] + (std::int64_t{1} << 62);
    ASSERT_EQ(decide(large, 0x1p62L).tunnel, decision.tunnel) << text_of(f);
    ++tested;
  }
  EXPECT_EQ(tested, 50);
}

// ---- the table

// The surfels of an annulus form a ring of three or more, each adjacent to the previous and the
// next one, whose segments are those of two loops; everything else is as without the tunnel.
TEST(Tunnel, EveryEntryIsARing) {
  const CellLoopTable& table = CellLoopTable::get();
  std::size_t seen = 0;
  for (std::size_t i = 0; i < table.entries().size() && !table.entries()[i].has_tunnel; ++i) {
    const CellLoops& plain = table.entries()[i];
    for (const Tunnel& t : table.tunnels(static_cast<std::uint16_t>(i))) {
      const CellLoops& cut = table[t.entry];
      ++seen;
      ASSERT_TRUE(cut.has_tunnel);
      ASSERT_EQ(cut.corners, plain.corners);
      ASSERT_EQ(cut.crossed, plain.crossed);
      ASSERT_EQ(cut.joined_faces, plain.joined_faces);
      ASSERT_LE(cut.surfels, kMaxSurfels);
      std::set<int> cut_loops;
      std::array<std::set<int>, kMaxSurfels> beside, loops_of_surfel;
      std::array<int, kMaxSurfels> cuts{};
      for (int e = 0; e < 12; ++e) {
        if (!(plain.crossed >> e & 1)) continue;
        const int a = cut.surfel_of_edge[e], b = cut.other_surfel_of_edge[e];
        ASSERT_LT(a, cut.surfels);
        ASSERT_LT(b, cut.surfels);
        ASSERT_EQ(plain.surfel_of_edge[e], plain.other_surfel_of_edge[e]);
        for (const int s : {a, b}) loops_of_surfel[s].insert(plain.surfel_of_edge[e]);
        if (a == b) continue;
        cut_loops.insert(plain.surfel_of_edge[e]);
        beside[a].insert(b);
        beside[b].insert(a);
        ++cuts[a];
        ++cuts[b];
      }
      ASSERT_EQ(cut_loops.size(), 2u);
      int pieces = 0;
      for (int s = 0; s < cut.surfels; ++s) {
        if (beside[s].empty()) {
          ASSERT_EQ(loops_of_surfel[s].size(), 1u);
          ASSERT_FALSE(cut_loops.count(*loops_of_surfel[s].begin()));
        } else {
          ++pieces;
          ASSERT_EQ(beside[s].size(), 2u);
          ASSERT_EQ(cuts[s], 4);  // two cuts, two ends each
          ASSERT_EQ(loops_of_surfel[s], cut_loops);
        }
      }
      ASSERT_GE(pieces, 3);
      ASSERT_EQ(cut.surfels - pieces, plain.loops - 2);
    }
  }
  EXPECT_EQ(seen + plain_entries(), table.entries().size());
}

// ---- whole volumes

SurfaceComplex trilinear_surface_of(const Samples& s, double isovalue = 0,
                                    Inside inside = Inside::above,
                                    SampleType type = SampleType::int32) {
  ParseOptions options;
  options.rule = {isovalue, inside, NonFinite::refuse};
  options.topology = Topology::trilinear;
  return parse_surface(to_volume(s, type), options);
}

TEST(TrilinearSurface, IsValidAndOfTheTopologyOfAFinerGrid) {
  Random random(16);
  int compared = 0;
  std::size_t tunnels = 0, all_tunnels = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Size size;
    for (std::size_t& n : size) n = static_cast<std::size_t>(random.between(2, 4));
    Samples s = random_samples(
        seed % 2 ? Family::white_noise : static_cast<Family>(seed / 2 % kFamilies), size, seed);
    for (std::int64_t planted = random.between(0, 2); planted > 0;
         --planted) {  // wide tunnels, also next to each other
      const std::int64_t sign = random.between(0, 1) ? 1 : -1, diagonal = random.between(0, 3);
      std::array<std::size_t, 3> low;
      for (std::size_t a = 0; a < 3; ++a)
        low[a] =
            static_cast<std::size_t>(random.between(0, static_cast<std::int64_t>(size[a]) - 2));
      for (std::int64_t c = 0; c < 8; ++c) {
        const bool on_diagonal = c == diagonal || c == 7 - diagonal;
        s.at(low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2)) =
            on_diagonal ? sign * random.between(500, 1000) : -sign * random.between(20, 120);
      }
    }
    if (!has_surface(s, 0)) continue;
    const SurfaceComplex surface = trilinear_surface_of(s);
    ASSERT_EQ(validate(surface), "") << seed;
    const TopologySummary topology = count_manifold(surface).topology;
    ASSERT_EQ(kinds_of(triangles_of(surface)), topology.kinds) << seed;
    const TopologySummary faces = reference_topology(s, 0);
    ASSERT_EQ(topology.boundary_loops, faces.boundary_loops) << seed;
    ASSERT_EQ(topology.euler_characteristic,
              faces.euler_characteristic - 2 * static_cast<std::int64_t>(surface.tunnels))
        << seed;
    all_tunnels += surface.tunnels;
    for (const std::int64_t n : {2, 4, 8, 16, 32}) {
      const Samples fine = refined(s, n);
      if (!loops_determine_the_topology(fine)) continue;
      ASSERT_EQ(text(topology.kinds), text(parsed_kinds(fine))) << "seed " << seed;
      ++compared;
      tunnels += surface.tunnels;
      break;
    }
  }
  std::printf("%d volumes compared, with %zu of %zu tunnels\n", compared, tunnels, all_tunnels);
  EXPECT_GT(compared, 250);
  EXPECT_GT(tunnels, 200u);
}

TEST(TrilinearSurface, TiesAndSymmetries) {
  std::size_t tunnels = 0;
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    const Samples s = random_samples(static_cast<Family>(seed % kFamilies), {8, 7, 6}, seed + 500);
    if (!has_surface(s, 0)) continue;
    const SurfaceComplex surface = trilinear_surface_of(s);
    const auto kinds = kinds_of(triangles_of(surface));
    tunnels += surface.tunnels;
    // A little more everywhere.
    Samples more = s;
    for (std::int64_t& v : more.values) v = 1000000000 * v + 1;
    const std::vector<std::pair<std::string, SurfaceComplex>> others{
        {"more", trilinear_surface_of(more, 0, Inside::above, SampleType::int64)},
        {"below", trilinear_surface_of(negated(s), 0, Inside::below)},
        {"mirrored", trilinear_surface_of(mirrored(s, static_cast<int>(seed % 3)))},
        {"turned", trilinear_surface_of(permuted(s, {1, 2, 0}))},
        {"swapped", trilinear_surface_of(permuted(s, {1, 0, 2}))},
        {"float", trilinear_surface_of(s, 0, Inside::above, SampleType::float32)}};
    for (const auto& [what, other] : others) {
      ASSERT_EQ(validate(other), "") << what << " " << seed;
      ASSERT_EQ(other.tunnels, surface.tunnels) << what << " " << seed;
      ASSERT_EQ(text(kinds_of(triangles_of(other))), text(kinds)) << what << " " << seed;
    }
  }
  EXPECT_GT(tunnels, 30u);
}

// Cells in which the level set of the trilinear interpolant is not a surface. The inside is joined
// there, as at a slightly lower level; at a slightly higher one it is not.
TEST(TrilinearSurface, SingularCells) {
  struct Singular {
    std::string name;
    std::array<std::int64_t, 8> corner;  // x + 2 y + 4 z
    std::size_t joined, separated;  // components of the trimmed surface at the level, and above it
  };
  const std::vector<Singular> cells{
      {"two planes that cross in a line", {1, -1, -1, 1, 1, -1, -1, 1}, 2, 2},
      {"three planes that cross in a point", {1, -1, -1, 1, -1, 1, 1, -1}, 4, 4},
      {"two cones with a common apex", {3, -1, -1, -1, -1, -1, -1, 3}, 1, 2},
      {"a saddle on one face", {1, -1, -1, 1, -5, -5, -5, -5}, 1, 2},
      {"saddles on two opposite faces", {1, -1, -1, 1, 2, -2, -2, 2}, 2, 2},
  };
  for (const Singular& cell : cells) {
    SCOPED_TRACE(cell.name);
    const auto kinds_at = [&](std::int64_t offset, Inside inside) {
      Samples samples = constant({2, 2, 2}, 0);
      const std::int64_t sign = inside == Inside::above ? 1 : -1;
      for (std::size_t c = 0; c < 8; ++c)
        samples.values[c] = sign * (1000000 * cell.corner[c] + offset);
      const SurfaceComplex surface = trilinear_surface_of(samples, 0, inside);
      EXPECT_EQ(validate(surface), "");
      return kinds_of(triangles_of(surface));
    };
    for (const Inside inside : {Inside::above, Inside::below}) {
      const auto components = [](const auto& kinds) {
        std::size_t count = 0;
        for (const TopologySummary::Kind& kind : kinds) count += kind.count;
        return count;
      };
      EXPECT_EQ(kinds_at(0, inside), kinds_at(1, inside)) << "a level that is a little lower";
      EXPECT_EQ(components(kinds_at(0, inside)), cell.joined);
      EXPECT_EQ(components(kinds_at(-1, inside)), cell.separated);
    }
  }
}

TEST(TrilinearSurface, NoTwoCVerticesCoincide) {
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    const Samples s = random_samples(static_cast<Family>(seed % kFamilies), {9, 9, 9}, seed + 900);
    if (!has_surface(s, 0)) continue;
    std::vector<std::array<double, 3>> places;
    for (const Vec3& p : trilinear_surface_of(s).positions) places.push_back({p.x, p.y, p.z});
    std::sort(places.begin(), places.end());
    ASSERT_EQ(std::adjacent_find(places.begin(), places.end()), places.end()) << seed;
  }
}

// Where no cell has a tunnel, the surface is the same, byte for byte.
TEST(TrilinearSurface, EqualsFacesWithoutTunnels) {
  const Samples s = sampled({20, 20, 20}, gyroid(9, 0.2));
  const SurfaceComplex faces = surface_of(s, 0, Inside::above, {1, 1, 1}, Topology::faces),
                       trilinear = trilinear_surface_of(s);
  EXPECT_EQ(trilinear.tunnels, 0u);
  EXPECT_EQ(faces.positions, trilinear.positions);
  ASSERT_EQ(faces.faces.size(), trilinear.faces.size());
  for (std::size_t i = 0; i < faces.faces.size(); ++i)
    ASSERT_EQ(faces.faces[i].corner, trilinear.faces[i].corner);
}

}  // namespace
}  // namespace isoatlas::detail
