// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <type_traits>
#include <utility>

#include "isoatlas/export.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// A scalar field that is given by a function of a world point, for example a distance function or
/// an implicit function. Several threads call `value` and `gradient` at the same time.
struct ScalarField {
  std::function<double(Vec3)> value;     ///< the value of the field at a world point
  std::function<Vec3(Vec3)> gradient{};  ///< in world units; optional, for vertex_normals()

  template <class F>
  requires(std::is_invocable_r_v<double, F, Vec3> &&
           !std::is_same_v<std::remove_cvref_t<F>, ScalarField>) ScalarField(F f)
      : value(std::move(f)) {}
  ScalarField(std::function<double(Vec3)> f, std::function<Vec3(Vec3)> g)
      : value(std::move(f)), gradient(std::move(g)) {}
};

/// Evaluates a field at the samples of a grid.
/// @return float64 samples on `grid`
/// @throws Error(bad_argument) if the field has no function, or the grid has fewer than two samples
///         along an axis or 2^50 samples or more
/// @throws Error(out_of_memory) if the samples do not fit into memory
/// @throws Error(cancelled) if `control.cancel` was set; exceptions of the function propagate
/// @post   the same field gives the same samples for any number of threads
/// @cost   one call of the function and 8 bytes per sample
ISOATLAS_API Volume sample(const ScalarField& field, const Grid& grid,
                           const RunControl& control = {});

/// Evaluates a field on a grid that fills a box.
/// @param low, high  opposite corners of the box in world coordinates, both sampled
/// @param spacing  distance between samples in world units; it is adjusted along each axis so that
///         a whole number of steps fits into the box
/// @throws Error(bad_argument) if the box has no length along an axis, or if the spacing is not
///         positive or gives more than a million samples along an axis
/// @throws Error as the overload with a grid
ISOATLAS_API Volume sample(const ScalarField& field, Vec3 low, Vec3 high, double spacing,
                           const RunControl& control = {});

}  // namespace isoatlas
