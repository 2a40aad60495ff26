// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <type_traits>
#include <utility>

#include "isoatlas/export.h"
#include "isoatlas/run_control.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// A scalar field given by a function of a point in the world, for example a distance or an
/// implicit function. Several threads call the functions at the same time.
struct ScalarField {
  std::function<double(Vec3)> value;
  std::function<Vec3(Vec3)> gradient{};  ///< optional; vertex_normals() uses it

  template <class F>
  requires(std::is_invocable_r_v<double, F, Vec3> &&
           !std::is_same_v<std::remove_cvref_t<F>, ScalarField>) ScalarField(F f)
      : value(std::move(f)) {}
  ScalarField(std::function<double(Vec3)> f, std::function<Vec3(Vec3)> g)
      : value(std::move(f)), gradient(std::move(g)) {}
};

/// The values of a field at the samples of a grid, as float64.
/// @throws Error(bad_argument) if the grid has fewer than two samples along an axis;
/// Error(out_of_memory); Error(cancelled); and whatever
///         the function throws
/// @post   same field, same samples, for any number of threads
/// @cost   one call per sample; 8 bytes per sample
ISOATLAS_API Volume sample(const ScalarField& field, const Grid& grid,
                           const RunControl& control = {});

/// The same in a box of the world. Along each axis the samples are `spacing` apart, adjusted so
/// that a whole number of steps fits.
/// @throws Error(bad_argument) if the box has no length along an axis, or the spacing is not
/// positive or gives more than a million samples
///         along an axis; and as above
ISOATLAS_API Volume sample(const ScalarField& field, Vec3 low, Vec3 high, double spacing,
                           const RunControl& control = {});

}  // namespace isoatlas
