// SPDX-License-Identifier: Apache-2.0
// Bounds, area and enclosed volume of a mesh and of its components.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "isoatlas/export.h"
#include "isoatlas/mesh.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// A box with sides along the axes.
struct BoundingBox {
  Vec3 low, high;
  friend bool operator==(const BoundingBox&, const BoundingBox&) = default;
};

/// The extent of one connected component of a mesh. Lengths are in the unit of the positions.
struct ComponentExtent {
  std::uint32_t component = 0;  ///< its index in MeshTopology::components
  std::size_t triangles = 0;
  BoundingBox bounds;  ///< of its vertices
  double area = 0;     ///< sum of the areas of its triangles
  /// The enclosed volume: positive if triangles face outwards, negative if they face inwards, as
  /// around a cavity. Absent if the component encloses none: it has a boundary, or an edge at which
  /// the orientations of its triangles do not cancel.
  std::optional<double> volume;
  /// As MeshTopology::components: meaningful only for an oriented manifold.
  ComponentTopology topology;
  friend bool operator==(const ComponentExtent&, const ComponentExtent&) = default;
};

/// Bounds, area and enclosed volume of the components of a mesh. Each is a compensated sum relative
/// to the middle of the component: distance from the origin and number of triangles cost no digits.
/// @param topology  of the same mesh
/// @return one entry per component, in the order of MeshTopology::components
/// @throws Error(bad_argument) if a corner is out of range, or `topology` is that of another mesh;
///         Error(cancelled)
/// @post   the same mesh gives the same bytes
/// @cost   O(V + T); O(T log T) if the mesh is not an oriented manifold
ISOATLAS_API std::vector<ComponentExtent> component_extents(const MeshView& mesh,
                                                            const MeshTopology& topology,
                                                            const RunControl& control = {});
/// The same; counts the topology first. O(T log T)
ISOATLAS_API std::vector<ComponentExtent> component_extents(const MeshView& mesh,
                                                            const RunControl& control = {});

/// The extent of a whole mesh.
struct MeshExtent {
  BoundingBox bounds;  ///< of all components; zero for a mesh without triangles
  double area = 0;     ///< sum over all components
  /// Sum over the components that enclose a volume; absent if none does. Cavities are subtracted,
  /// because their volume is negative.
  std::optional<double> volume;
  std::size_t components = 0;
  std::size_t open_components = 0;  ///< components without a volume
  /// The components with the largest areas, largest first (ties: smaller index first).
  std::vector<ComponentExtent> largest;
  friend bool operator==(const MeshExtent&, const MeshExtent&) = default;
};

/// Number of components that the report of a level lists.
constexpr std::size_t kListedComponents = 100;

/// Adds up the extents of components.
/// @param listed  upper limit of the size of MeshExtent::largest
/// @cost O(n log n)
ISOATLAS_API MeshExtent summarize(const std::vector<ComponentExtent>& components,
                                  std::size_t listed = kListedComponents);

}  // namespace isoatlas
