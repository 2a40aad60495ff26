// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace isoatlas::detail {

/// The float32 value nearest to `x`, as a double; infinite beyond the range of float32. The only
/// place that rounds coordinates to float32: g++ 12 drops a conversion to float that is widened
/// again, unless the float is volatile.
inline double to_float32(double x) {
  const volatile float value = static_cast<float>(x);
  return value;
}

}  // namespace isoatlas::detail
