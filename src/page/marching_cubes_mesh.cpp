// SPDX-License-Identifier: Apache-2.0
#include "page/marching_cubes_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "field/sample_type.h"
#include "page/marching_cubes_cases.h"

namespace isoatlas::detail::page {
namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

/// The vertices on the grid edges of one direction in one layer.
class EdgeVertices {
 public:
  explicit EdgeVertices(std::size_t edges) : vertex_(edges, kNoVertex) {}
  std::uint32_t at(std::size_t edge) const { return vertex_[edge]; }
  void set(std::size_t edge, std::uint32_t vertex) {
    vertex_[edge] = vertex;
    used_.push_back(edge);
  }
  void clear() {
    for (const std::size_t edge : used_) vertex_[edge] = kNoVertex;
    used_.clear();
  }

 private:
  std::vector<std::uint32_t> vertex_;
  std::vector<std::size_t> used_;  // the edges that have a vertex
};

/// A grid edge of a grid cell: its lower end, relative to corner 0, and its axis.
struct CellEdge {
  std::uint8_t x, y, z, axis;
};
constexpr std::array<CellEdge, 12> kCellEdges{{{0, 0, 0, 0},
                                               {1, 0, 0, 1},
                                               {0, 1, 0, 0},
                                               {0, 0, 0, 1},
                                               {0, 0, 1, 0},
                                               {1, 0, 1, 1},
                                               {0, 1, 1, 0},
                                               {0, 0, 1, 1},
                                               {0, 0, 0, 2},
                                               {1, 0, 0, 2},
                                               {0, 1, 0, 2},
                                               {1, 1, 0, 2}}};

/// Four neighbouring samples with the same x, as bits of a case: corners 0, 3, 4 and 7.
constexpr std::array<unsigned, 4> kLeftBits{1U << 0, 1U << 3, 1U << 4, 1U << 7};

/// The same bits for the four samples at x + 1: corners 1, 2, 5 and 6.
constexpr unsigned to_right_side(unsigned left) {
  return (left & 1U << 0) << 1 | (left & 1U << 3) >> 1 | (left & 1U << 4) << 1 |
         (left & 1U << 7) >> 1;
}

template <class T>
class Marcher {
 public:
  Marcher(const VolumeView& volume, double isovalue)
      : samples_(static_cast<const T*>(volume.samples)),
        nx_(static_cast<std::size_t>(volume.grid.size[0])),
        ny_(static_cast<std::size_t>(volume.grid.size[1])),
        nz_(static_cast<std::size_t>(volume.grid.size[2])),
        spacing_(volume.grid.spacing),
        isovalue_(isovalue),
        along_x_{EdgeVertices(nx_ * ny_), EdgeVertices(nx_ * ny_)},
        along_y_{EdgeVertices(nx_ * ny_), EdgeVertices(nx_ * ny_)},
        along_z_(nx_ * ny_) {}

  TriangleMesh mesh() {
    for (std::size_t z = 0; z + 1 < nz_; ++z) {
      for (std::size_t y = 0; y + 1 < ny_; ++y) add_row(y, z);
      std::swap(along_x_[0], along_x_[1]);
      std::swap(along_y_[0], along_y_[1]);
      along_x_[1].clear();
      along_y_[1].clear();
      along_z_.clear();
    }
    return std::move(mesh_);
  }

 private:
  void add_row(std::size_t y, std::size_t z) {
    const T* const first = samples_ + nx_ * (y + ny_ * z);
    const std::array<const T*, 4> rows{first, first + nx_, first + nx_ * ny_,
                                       first + nx_ * ny_ + nx_};
    unsigned left = inside_bits(rows, 0);
    for (std::size_t x = 0; x + 1 < nx_; ++x) {
      const unsigned right = inside_bits(rows, x + 1);
      const unsigned cell_case = left | to_right_side(right);
      if (cell_case != 0 && cell_case != 255) add_cell(cell_case, x, y, z);
      left = right;
    }
  }

  unsigned inside_bits(const std::array<const T*, 4>& rows, std::size_t x) const {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 4; ++k)
      bits |= static_cast<double>(rows[k][x]) >= isovalue_ ? kLeftBits[k] : 0U;
    return bits;
  }

  void add_cell(unsigned cell_case, std::size_t x, std::size_t y, std::size_t z) {
    const std::string_view edges = kMarchingCubesCases[cell_case];
    for (std::size_t i = 0; i < edges.size(); i += 3) {
      Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const char digit = edges[i + k];
        const int edge = digit <= '9' ? digit - '0' : digit - 'a' + 10;
        triangle[k] = vertex_on(kCellEdges[static_cast<std::size_t>(edge)], x, y, z);
      }
      mesh_.triangles.push_back(triangle);
    }
  }

  std::uint32_t vertex_on(const CellEdge& edge, std::size_t x, std::size_t y, std::size_t z) {
    EdgeVertices& vertices = edge.axis == 2   ? along_z_
                             : edge.axis == 1 ? along_y_[edge.z]
                                              : along_x_[edge.z];
    const std::size_t place = x + edge.x + nx_ * (y + edge.y);
    if (vertices.at(place) == kNoVertex) {
      vertices.set(place, static_cast<std::uint32_t>(mesh_.positions.size()));
      mesh_.positions.push_back(position_on(edge, x + edge.x, y + edge.y, z + edge.z));
    }
    return vertices.at(place);
  }

  Vec3 position_on(const CellEdge& edge, std::size_t x, std::size_t y, std::size_t z) const {
    const std::size_t at = x + nx_ * (y + ny_ * z);
    const std::array<std::size_t, 3> step{1, nx_, nx_ * ny_};
    const auto low = static_cast<double>(samples_[at]);
    const auto high = static_cast<double>(samples_[at + step[edge.axis]]);
    const double part = (isovalue_ - low) / (high - low);
    Vec3 index{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    (edge.axis == 0 ? index.x : edge.axis == 1 ? index.y : index.z) += part;
    return {index.x * spacing_.x, index.y * spacing_.y, index.z * spacing_.z};
  }

  const T* samples_;
  std::size_t nx_, ny_, nz_;
  Vec3 spacing_;
  double isovalue_;
  std::array<EdgeVertices, 2> along_x_, along_y_;  // of the lower and the upper layer
  EdgeVertices along_z_;                           // between the two layers
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh marching_cubes_mesh(const VolumeView& volume, double isovalue) {
  return visit_sample_type(volume.type, [&](auto* sample) {
    using T = std::remove_const_t<std::remove_pointer_t<decltype(sample)>>;
    return Marcher<T>(volume, isovalue).mesh();
  });
}

}  // namespace isoatlas::detail::page
