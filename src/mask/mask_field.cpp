// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/mask_field.h"

#include <cmath>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/require.h"
#include "field/dense_volume.h"
#include "field/sample_type.h"
#include "mask/band.h"
#include "mask/repair_faces.h"
#include "mask/smooth_field.h"

namespace isoatlas {
using namespace detail;
namespace {

constexpr std::size_t kSamplesOfMaskSamplesOfMaskPerChunk = 1 << 16;

Volume volume_of(const Grid& grid, std::shared_ptr<std::vector<float>> samples) {
  Volume out;
  out.view = VolumeView::of(*samples, grid.size);
  out.view.grid = grid;
  out.owner = std::move(samples);
  return out;
}

}  // namespace

Volume mask_field(const VolumeView& mask, const MaskFieldOptions& options,
                  const RunControl& control) {
  const ThreadLimit limit(control.threads);
  const Grid& grid = mask.grid;
  for (const std::size_t n : grid.size)
    require(n >= 2,
            "the mask has " + std::to_string(n) + " samples along an axis; expected at least 2");
  std::vector<std::uint8_t> inside(grid.sample_count());
  const Volume dense = dense_volume(mask);
  visit_samples(dense.view, [&]<class T>(std::span<const T> samples) {
    for_each_index(inside.size(), kSamplesOfMaskSamplesOfMaskPerChunk, &control,
                   [&](std::size_t i) {
                     if constexpr (std::is_floating_point_v<T>)
                       inside[i] = samples[i] != 0 && !std::isnan(samples[i]);
                     else
                       inside[i] = samples[i] != 0;
                   });
  });
  control.report("mask", 0);
  const Band band = make_band(grid, inside, control);
  control.report("mask", 0.3);
  std::vector<float> near = smooth_field(band, grid, control);
  repair_faces(band, options.connectivity, near, control);
  control.report("mask", 1);

  float farthest = 0;
  for (const float f : near) farthest = std::max(farthest, std::abs(f));
  auto field = std::make_shared<std::vector<float>>(inside.size());
  for_each_index(inside.size(), kSamplesOfMaskSamplesOfMaskPerChunk, &control,
                 [&](std::size_t i) { (*field)[i] = inside[i] != 0 ? farthest : -farthest; });
  for (std::size_t i = 0; i < band.size(); ++i) (*field)[band.sample[i]] = near[i];
  return volume_of(grid, std::move(field));
}

}  // namespace isoatlas
