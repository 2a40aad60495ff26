// SPDX-License-Identifier: Apache-2.0
#include "field/sample_type.h"

namespace isoatlas {
using namespace detail;

std::string_view name(SampleType type) {
  switch (type) {
    case SampleType::int8:
      return "int8";
    case SampleType::uint8:
      return "uint8";
    case SampleType::int16:
      return "int16";
    case SampleType::uint16:
      return "uint16";
    case SampleType::int32:
      return "int32";
    case SampleType::uint32:
      return "uint32";
    case SampleType::int64:
      return "int64";
    case SampleType::uint64:
      return "uint64";
    case SampleType::float32:
      return "float32";
    case SampleType::float64:
      return "float64";
  }
  return "unknown";
}

std::size_t bytes_per_sample(SampleType type) {
  return visit_sample_type(type, [](auto* p) { return sizeof(*p); });
}

}  // namespace isoatlas
