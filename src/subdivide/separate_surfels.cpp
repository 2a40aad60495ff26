// SPDX-License-Identifier: Apache-2.0
#include "subdivide/separate_surfels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>

#include "core/parallel.h"
#include "core/vector_math.h"
#include "embed/triangle_pair.h"

namespace isoatlas {
namespace {

constexpr std::size_t kCellsPerPiece = 64;
constexpr double kMargin = 0.02;  // from a cell's walls, on which the whole border of a surfel's piece may be
// How far c-vertices are moved towards the middle of their surfel's border, one share after the other.
constexpr std::array kShares{0.25, 0.5, 0.75, 1.0};

using Cell = std::array<double, 3>;
Cell cell_of(Vec3 p) { return {std::floor(p.x), std::floor(p.y), std::floor(p.z)}; }
bool is_in_cell(Vec3 p) { return p.x != std::floor(p.x) && p.y != std::floor(p.y) && p.z != std::floor(p.z); }

Vec3 inside(const Cell& cell, Vec3 p) {
  const auto clamp = [](double low, double x) { return std::clamp(x, low + kMargin, low + 1 - kMargin); };
  return {clamp(cell[0], p.x), clamp(cell[1], p.y), clamp(cell[2], p.z)};
}

bool meet(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = i + 1; j < triangles.size(); ++j) {
      if (meet_beyond_shared(positions, triangles[i], triangles[j])) return true;
    }
  }
  return false;
}

}  // namespace

std::size_t separate_surfels(SurfaceComplex& complex, const TrilinearField& field) {
  // Parsing numbers the c-vertices of a cell one after the other.
  std::vector<CVertexId> crowded;
  const std::uint32_t n = complex.c_vertex_count();
  const auto same_cell = [&](CVertexId a, CVertexId b) {
    return is_in_cell(complex.positions[a]) && is_in_cell(complex.positions[b]) &&
           cell_of(complex.positions[a]) == cell_of(complex.positions[b]);
  };
  for (CVertexId v = 0; v < n; ++v) {
    if ((v > 0 && same_cell(v - 1, v)) || (v + 1 < n && same_cell(v, v + 1))) crowded.push_back(v);
  }
  if (crowded.empty()) return 0;

  // Their faces as pieces of surfels, cell by cell.
  const std::vector<std::uint8_t> stays = stays_in_cells(complex);
  std::vector<CVertexId> wanted;
  std::copy_if(crowded.begin(), crowded.end(), std::back_inserter(wanted), [&](CVertexId v) { return !stays[v]; });
  Subdivision divided = subdivide(complex, wanted, field);
  std::vector<Vec3>& positions = divided.complex.positions;
  std::vector<std::uint32_t> place(n, kNone);  // in `crowded`
  for (std::uint32_t i = 0; i < crowded.size(); ++i) place[crowded[i]] = i;
  std::vector<std::uint32_t> first{0};  // of each cell, in `crowded`
  for (std::uint32_t i = 1; i < crowded.size(); ++i) {
    if (!same_cell(crowded[i - 1], crowded[i])) first.push_back(i);
  }
  first.push_back(static_cast<std::uint32_t>(crowded.size()));
  std::vector<std::pair<std::uint32_t, Triangle>> pieces;  // place of a c-vertex, triangle
  for (const Face& face : divided.complex.faces) {
    if (!face.is_triangle()) continue;
    for (int k = 0; k < 3; ++k) {
      const CVertexId v = face.corner[k];
      if (v >= n || place[v] == kNone) continue;
      pieces.emplace_back(place[v], Triangle{face.corner[0], face.corner[1], face.corner[2]});
      break;
    }
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  std::atomic<std::size_t> left = 0;
  for_each_piece(first.size() - 1, kCellsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<Triangle> triangles;
    for (std::size_t c = begin; c < end; ++c) {
      triangles.clear();
      const auto by_place = [](const auto& piece, std::uint32_t i) { return piece.first < i; };
      const auto from = std::lower_bound(pieces.begin(), pieces.end(), first[c], by_place);
      const auto to = std::lower_bound(from, pieces.end(), first[c + 1], by_place);
      for (auto at = from; at != to; ++at) triangles.push_back(at->second);
      if (!meet(positions, triangles)) continue;
      const std::span<const CVertexId> own{crowded.data() + first[c], crowded.data() + first[c + 1]};
      std::vector<Vec3> start, middle;
      for (const CVertexId v : own) {
        Vec3 sum;
        std::size_t count = 0;
        for (const Triangle& t : triangles) {
          for (const std::uint32_t w : t) {
            if (std::find(t.begin(), t.end(), v) == t.end() || w == v) continue;
            sum = sum + positions[w];
            ++count;
          }
        }
        start.push_back(positions[v]);
        middle.push_back(count == 0 ? positions[v] : inside(cell_of(positions[v]), (1.0 / static_cast<double>(count)) * sum));
      }
      bool good = false;
      for (const double share : kShares) {
        for (std::size_t k = 0; k < own.size(); ++k) positions[own[k]] = start[k] + share * (middle[k] - start[k]);
        good = !meet(positions, triangles);
        if (good) break;
      }
      if (!good) {
        ++left;
        for (std::size_t k = 0; k < own.size(); ++k) positions[own[k]] = start[k];
      }
      for (const CVertexId v : own) complex.positions[v] = positions[v];
    }
  });
  return left;
}

}  // namespace isoatlas
