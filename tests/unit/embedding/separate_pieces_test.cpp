// SPDX-License-Identifier: Apache-2.0
#include "embedding/separate_pieces.h"

#include <gtest/gtest.h>

#include <vector>

#include "geometry/triangle_pair.h"

namespace isoatlas::detail {
namespace {

// Flat layers, each a square with its midpoint at the height of the layer, in one grid cell. The
// midpoints may rise.
struct Layers {
  std::vector<Vec3> positions;
  std::vector<Piece> pieces;
  std::vector<FreePoint> free;

  void add(double height, double risen, GridCell grid_cell = {0, 0, 0}) {
    const auto v = static_cast<CVertexId>(positions.size());
    const double x = grid_cell[0];
    for (const auto& [u, w] : {std::pair(0.1, 0.1), {0.9, 0.1}, {0.9, 0.9}, {0.1, 0.9}})
      positions.push_back({x + u, w, height});
    positions.push_back({x + 0.5, 0.5, height + risen});
    free.push_back({v + 4, {x + 0.5, 0.5, height}});
    for (CVertexId k = 0; k < 4; ++k)
      pieces.push_back({grid_cell, {v + k, v + (k + 1) % 4, v + 4}});
  }
  bool any_intersect() const {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (std::size_t j = i + 1; j < pieces.size(); ++j) {
        if (intersect_beyond_shared_simplex(positions, pieces[i].corners, pieces[j].corners))
          return true;
      }
    }
    return false;
  }
  double height(std::size_t layer) const { return positions[5 * layer + 4].z; }
};

TEST(SeparatePieces, PointsWithoutIntersectionsStay) {
  Layers layers;
  layers.add(0.25, 0.25);
  layers.add(0.5, 0.125);
  separate_pieces(layers.free, layers.pieces, layers.positions, {});
  EXPECT_EQ(layers.height(0), 0.5);
  EXPECT_EQ(layers.height(1), 0.625);
}

TEST(SeparatePieces, OnlyIntersectingPiecesMoveAndOnlyAsFarAsNeeded) {
  Layers layers;
  layers.add(0.25, 0.375);  // through the next layer, but not at half of the height
  layers.add(0.5, 0);
  layers.add(0.75, 0.125);           // above both
  layers.add(0.25, 0.5, {1, 0, 0});  // in another grid cell
  ASSERT_TRUE(layers.any_intersect());
  separate_pieces(layers.free, layers.pieces, layers.positions, {});
  EXPECT_FALSE(layers.any_intersect());
  EXPECT_EQ(layers.height(0), 0.4375);
  EXPECT_EQ(layers.height(2), 0.875);
  EXPECT_EQ(layers.height(3), 0.75);
}

TEST(SeparatePieces, PointsEndAtTheirFlatPositions) {
  Layers layers;
  layers.add(0.25, 0.5);
  layers.add(0.28125, -0.125);
  separate_pieces(layers.free, layers.pieces, layers.positions, {});
  EXPECT_FALSE(layers.any_intersect());
  EXPECT_EQ(layers.height(0), 0.25);
  EXPECT_EQ(layers.height(1), 0.28125);
}

}  // namespace
}  // namespace isoatlas::detail
