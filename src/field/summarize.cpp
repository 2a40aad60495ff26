// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <new>
#include <type_traits>

#include "core/require.h"
#include "field/dense_volume.h"
#include "field/sample_type.h"
#include "isoatlas/error.h"

namespace isoatlas {
using namespace detail;
namespace {

template <class T>
SampleSummary summarize_samples(const Grid& grid, const T* samples) {
  SampleSummary out;
  const std::size_t n = grid.sample_count();
  bool any = false;
  T low{}, high{};
  for (std::size_t i = 0; i < n; ++i) {
    const T v = samples[i];
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(v)) {
        if (out.nan_count + out.infinity_count == 0) {
          out.first_non_finite = {i % grid.size[0], i / grid.size[0] % grid.size[1],
                                  i / grid.size[0] / grid.size[1]};
        }
        ++(std::isnan(v) ? out.nan_count : out.infinity_count);
        continue;
      }
    }
    if (!any) low = high = v;
    any = true;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  out.minimum = static_cast<double>(low);
  out.maximum = static_cast<double>(high);
  out.finite_count = n - out.nan_count - out.infinity_count;
  return out;
}

}  // namespace

SampleSummary summarize(const VolumeView& any_volume) try {
  require(any_volume.samples != nullptr || any_volume.grid.sample_count() == 0,
          "the volume has no samples");
  const Volume kept = dense_volume(any_volume);
  const VolumeView& volume = kept.view;
  return visit_sample_type(volume.type, [&]<class T>(const T*) {
    return summarize_samples(volume.grid, static_cast<const T*>(volume.samples));
  });
} catch (const std::bad_alloc&) {
  throw Error(ErrorCode::out_of_memory, "not enough memory to copy these samples");
}

}  // namespace isoatlas
