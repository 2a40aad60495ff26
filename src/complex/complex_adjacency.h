// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "complex/surface_complex.h"
#include "core/slack_rows.h"
#include "isoatlas/run_control.h"

namespace isoatlas::detail {

/// The neighbourhood of each c-vertex of a complex: its faces, and its neighbours along the
/// boundary.
class ComplexAdjacency {
 public:
  ComplexAdjacency() = default;
  /// O(F). 12 bytes per c-vertex and 4 per corner of a face, 8 more per c-vertex if there is a
  /// boundary.
  explicit ComplexAdjacency(const SurfaceComplex& complex, const RunControl& control = {});

  std::span<const FaceId> faces_of(CVertexId v) const { return faces_.row(v); }
  /// The c-vertex after v on its boundary loop, in the direction of the boundary sides; kNone
  /// inside the surface.
  CVertexId next_on_boundary(CVertexId v) const { return v < next_.size() ? next_[v] : kNone; }
  CVertexId previous_on_boundary(CVertexId v) const {
    return v < previous_.size() ? previous_[v] : kNone;
  }

 private:
  SlackRows<FaceId> faces_;
  std::vector<CVertexId> next_, previous_;  // empty if there is no boundary
};

}  // namespace isoatlas::detail
