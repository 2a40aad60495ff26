// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "isoatlas/error.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail {

/// Calls f with a null pointer to the C++ type of `type`. The only place that maps sample types to
/// C++ types.
template <class F>
decltype(auto) visit_sample_type(SampleType type, F&& f) {
  switch (type) {
    case SampleType::int8:
      return f(static_cast<const std::int8_t*>(nullptr));
    case SampleType::uint8:
      return f(static_cast<const std::uint8_t*>(nullptr));
    case SampleType::int16:
      return f(static_cast<const std::int16_t*>(nullptr));
    case SampleType::uint16:
      return f(static_cast<const std::uint16_t*>(nullptr));
    case SampleType::int32:
      return f(static_cast<const std::int32_t*>(nullptr));
    case SampleType::uint32:
      return f(static_cast<const std::uint32_t*>(nullptr));
    case SampleType::int64:
      return f(static_cast<const std::int64_t*>(nullptr));
    case SampleType::uint64:
      return f(static_cast<const std::uint64_t*>(nullptr));
    case SampleType::float32:
      return f(static_cast<const float*>(nullptr));
    case SampleType::float64:
      return f(static_cast<const double*>(nullptr));
  }
  throw Error(ErrorCode::bad_argument, "unknown sample type");
}

/// Calls f with a span of the samples of a dense volume, in their own type.
template <class F>
void visit_samples(const VolumeView& volume, F&& f) {
  visit_sample_type(volume.type, [&]<class T>(const T*) {
    f(std::span<const T>(static_cast<const T*>(volume.samples), volume.grid.sample_count()));
  });
}

}  // namespace isoatlas::detail
