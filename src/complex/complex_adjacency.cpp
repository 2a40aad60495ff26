// SPDX-License-Identifier: Apache-2.0
#include "complex/complex_adjacency.h"

#include "core/cancel_poll.h"

namespace isoatlas::detail {

ComplexAdjacency::ComplexAdjacency(const SurfaceComplex& complex, const RunControl& control) {
  std::vector<std::uint32_t> count(complex.c_vertex_count(), 0);
  for (const Face& face : complex.faces) {
    for (int k = 0; k < face.size(); ++k) ++count[face.corner[k]];
  }
  faces_.reserve(count);
  CancelPoll poll(control);
  for (FaceId f = 0; f < complex.face_count(); ++f) {
    poll.step();
    const Face& face = complex.faces[f];
    for (int k = 0; k < face.size(); ++k) faces_.push_back(face.corner[k], f);
  }
  if (complex.boundary.empty()) return;
  next_.assign(complex.c_vertex_count(), kNone);
  previous_.assign(complex.c_vertex_count(), kNone);
  for (const BoundarySide& side : complex.boundary) {
    next_[side.from] = side.to;
    previous_[side.to] = side.from;
  }
}

}  // namespace isoatlas::detail
